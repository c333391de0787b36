#include "solve/log_map.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace pvg {

using Complex = std::complex<double>;

namespace {

/// The place of a face's third corner c from those of a and b; edge: the length of ab, turn: c - a over b - a in the face's
/// plane. The face is laid flat with the centre where the distances of a and b have it; that gives the distance of c, and c's
/// direction lies between theirs as it does there. Where the surface is not flat, places of a and b are not as far apart as a and
/// b are: laying the face on them would scale it, and on saddles the error feeds itself until the map folds over.
Complex third_place(Complex a, Complex b, double edge, Complex turn) {
    const double apart = std::abs(b - a), to_a = std::abs(a), to_b = std::abs(b);
    if (std::abs(apart - edge) <= 1e-9 * edge || !(to_a > 0) || !(to_b > 0))
        return a + turn * (b - a);
    const double along = (edge * edge + to_a * to_a - to_b * to_b) / (2 * edge), square = to_a * to_a - along * along;
    // a is at 0, b at edge; where no such triangle exists, the nearer of the two is passed on the way to the other.
    Complex centre(to_a < to_b ? -to_a : edge + to_b, 0);
    if (square > 0)
        centre = {along, std::imag(-a * std::conj(b - a)) < 0 ? -std::sqrt(square) : std::sqrt(square)};
    const Complex c = edge * turn - centre;
    if (!(std::abs(c) > 0))
        return 0;
    const Complex from_a = c / -centre, from_b = c / (edge - centre);
    const double turn_a = std::abs(std::arg(from_a)), turn_b = std::abs(std::arg(from_b));
    const double share = turn_a + turn_b > 0 ? turn_a / (turn_a + turn_b) : 0.5;
    const Complex direction = (1 - share) * a / to_a * from_a / std::abs(from_a) + share * b / to_b * from_b / std::abs(from_b);
    return std::abs(direction) > 0 ? std::abs(c) / std::abs(direction) * direction : a + turn * (b - a);
}

}  // namespace

LogMap::LogMap(const Surface& surface, const std::vector<int>& partner)
    : partner_(partner),
      triangulation_(intrinsic_triangulation(surface)),
      outgoing_(surface.vertex_count(), none),
      turn_(surface.halfedge_count()) {
    make_delaunay(triangulation_);
    for (int h = 0; h < surface.halfedge_count(); ++h) {
        int& chosen = outgoing_[origin(h)];
        if (chosen == none || (triangulation_.twin[h] == none && triangulation_.twin[chosen] != none))
            chosen = h;
        const double along = length(h), back = length(Surface::prev(h)), size = along * along;
        // The angle at h's origin is the one opposite the next halfedge.
        const OppositeAngle angle = opposite_angle(triangulation_, Surface::next(h));
        if (size > 0 && back > 0)
            turn_[h] = {angle.cosine / size, angle.sine / size};
    }
}

void LogMap::unfold(const std::vector<int>& vertices, const std::vector<int>& local, Buffers& buffers,
                    std::vector<Complex>& place) const {
    const std::size_t count = vertices.size();
    // A vertex takes the mean of the places that the faces laid before it give: where the surface is curved they differ, and a
    // single one would leave cracks between branches of the unfolding. Nearest first; equal distances by number, the same order
    // everywhere.
    auto& [sum, reach, votes, laid, queue] = buffers;
    sum.assign(count, 0);
    reach.assign(count, 0);
    votes.assign(count, 0);
    laid.assign(count, 0);
    queue.clear();
    place.assign(count, 0);
    const auto vote = [&](int v, Complex at) {
        if (v == none || laid[v])
            return;
        sum[v] += at;
        reach[v] += std::abs(at);
        if (++votes[v] > 1)
            return;
        queue.emplace_back(std::norm(at), v);
        std::push_heap(queue.begin(), queue.end(), std::greater<>());
    };
    const auto lay_fan = [&](int vertex) {
        const int start = outgoing_[vertex];
        double total = 0;
        int h = start;
        while (h != none) {
            total += std::arg(turn_[h]);
            h = triangulation_.twin[Surface::prev(h)];
            if (h == start)
                break;
        }
        const double scale = h == none || total <= 0 ? 1 : 2 * std::numbers::pi / total;
        double angle = 0;
        h = start;
        while (h != none) {
            vote(local[target(h)], std::polar(length(h), angle));
            angle += scale * std::arg(turn_[h]);
            const int last = Surface::prev(h);
            h = triangulation_.twin[last];
            if (h == none)
                vote(local[origin(last)], std::polar(length(last), angle));
            if (h == start)
                break;
        }
    };
    // Faces of the vertex with one corner left to lay.
    const auto unfold_around = [&](int vertex) {
        const int start = outgoing_[vertex], i = local[vertex];
        int h = start;
        while (h != none) {
            const int last = Surface::prev(h);
            const int j = local[target(h)], m = local[origin(last)];
            if (j != none && m != none && laid[j] != laid[m] && turn_[h] != 0.0) {
                const double edge = length(h);
                if (laid[j])
                    vote(m, third_place(place[i], place[j], edge, turn_[h]));
                else
                    vote(j, third_place(place[i], place[m], edge * std::abs(turn_[h]), 1.0 / turn_[h]));
            }
            h = triangulation_.twin[last];
            if (h == start)
                break;
        }
    };
    const auto settle = [&](int v, Complex at) {
        laid[v] = 1;
        place[v] = at;
        unfold_around(vertices[v]);
        for (int copy = partner_[vertices[v]]; copy != none && copy != vertices[v]; copy = partner_[copy]) {
            if (local[copy] == none || laid[local[copy]])
                continue;
            laid[local[copy]] = 1;
            place[local[copy]] = at;
            unfold_around(copy);
        }
    };

    lay_fan(vertices[0]);
    settle(0, 0);
    while (!queue.empty()) {
        std::pop_heap(queue.begin(), queue.end(), std::greater<>());
        const int v = queue.back().second;
        queue.pop_back();
        if (!laid[v])
            settle(v, std::abs(sum[v]) > 0 ? reach[v] / (votes[v] * std::abs(sum[v])) * sum[v] : sum[v]);
    }

    for (std::size_t v = 0; v < count; ++v) {
        if (laid[v])
            continue;
        const int start = outgoing_[vertices[v]];
        int h = start;
        while (h != none) {
            for (int w : {local[target(h)], local[origin(Surface::prev(h))]})
                if (w != none && laid[w])
                    place[v] = place[w];
            h = triangulation_.twin[Surface::prev(h)];
            if (h == start)
                break;
        }
    }
}

}  // namespace pvg
