#include "solve/log_map.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <span>

namespace pvg {

using Complex = std::complex<double>;

namespace {

/// std::complex without its care for infinities and overflow: lengths of a mesh are far from both, and this is most of what a map
/// costs.
struct Vector {
    double x = 0, y = 0;
    friend Vector operator+(Vector a, Vector b) { return {a.x + b.x, a.y + b.y}; }
    friend Vector operator-(Vector a, Vector b) { return {a.x - b.x, a.y - b.y}; }
    friend Vector operator*(double s, Vector a) { return {s * a.x, s * a.y}; }
    /// The complex product: turned and scaled.
    friend Vector operator*(Vector a, Vector b) { return {a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x}; }
    double norm() const { return x * x + y * y; }
    double size() const { return std::sqrt(norm()); }
    Vector mirrored() const { return {x, -y}; }
};
Vector plain(Complex z) { return {z.real(), z.imag()}; }

/// The place of a face's third corner c from those of a and b; edge: the length of ab, turn: c - a over b - a in the face's
/// plane. The face is laid flat with the centre where the distances of a and b have it; that gives the distance of c, and c's
/// direction lies between theirs as it does there. Where the surface is not flat, places of a and b are not as far apart as a and
/// b are: laying the face on them would scale it, and on saddles the error feeds itself until the map folds over.
Vector third_place(Vector a, Vector b, double edge, Vector turn) {
    const Vector ab = b - a;
    const double apart = ab.size(), a_norm = a.norm(), b_norm = b.norm();
    if (std::abs(apart - edge) <= 1e-9 * edge || !(a_norm > 0) || !(b_norm > 0))
        return a + turn * ab;
    const double along = (edge * edge + a_norm - b_norm) / (2 * edge), square = a_norm - along * along;
    // a is at 0, b at edge; where no such triangle exists, the nearer of the two is passed on the way to the other.
    Vector centre;
    if (square > 0)
        centre = {along, a.x * ab.y - a.y * ab.x < 0 ? -std::sqrt(square) : std::sqrt(square)};
    else
        centre = {a_norm < b_norm ? -std::sqrt(a_norm) : edge + std::sqrt(b_norm), 0};
    const Vector c = edge * turn - centre, to_b = {edge - centre.x, -centre.y};
    const double c_norm = c.norm();
    if (!(c_norm > 0))
        return {};
    // How c's direction is turned from those of a and b, as seen from the centre.
    const Vector from_a = c * Vector{-centre.x, centre.y}, from_b = c * to_b.mirrored();
    const double turn_a = std::abs(std::atan2(from_a.y, from_a.x)), turn_b = std::abs(std::atan2(from_b.y, from_b.x));
    const double share = turn_a + turn_b > 0 ? turn_a / (turn_a + turn_b) : 0.5;
    const Vector direction =
        (1 - share) / std::sqrt(a_norm * from_a.norm()) * (a * from_a) + share / std::sqrt(b_norm * from_b.norm()) * (b * from_b);
    const double norm = direction.norm();
    return norm > 0 ? std::sqrt(c_norm / norm) * direction : a + turn * ab;
}

}  // namespace

LogMap::LogMap(const Surface& surface, const std::vector<int>& partner) : partner_(partner) {
    IntrinsicTriangulation triangulation = intrinsic_triangulation(surface);
    make_delaunay(triangulation);
    const int vertices = surface.vertex_count();
    const auto origin = [&](int h) { return triangulation.faces[h / 3][h % 3]; };
    const auto length = [&](int h) { return triangulation.lengths[h / 3][h % 3]; };
    std::vector<int> outgoing(vertices, none);
    for (int h = 0; h < surface.halfedge_count(); ++h)
        if (int& chosen = outgoing[origin(h)];
            chosen == none || (triangulation.twin[h] == none && triangulation.twin[chosen] != none))
            chosen = h;
    corners_.reserve(surface.halfedge_count());
    corner_first_.assign(1, 0);
    closed_.assign(vertices, 0);
    for (int v = 0; v < vertices; ++v) {
        for (int h = outgoing[v]; h != none;) {
            const int next = Surface::next(h), prev = Surface::prev(h);
            Corner& corner = corners_.emplace_back();
            corner.target = origin(next);
            corner.third = origin(prev);
            corner.length = length(h);
            const double size = corner.length * corner.length;
            const OppositeAngle angle = opposite_angle(triangulation, next);  // opposite the next halfedge: at v
            if (size > 0 && length(prev) > 0) {
                corner.turn_x = angle.cosine / size;
                corner.turn_y = angle.sine / size;
            }
            h = triangulation.twin[prev];
            if (h == outgoing[v]) {
                closed_[v] = 1;
                break;
            }
        }
        corner_first_.push_back(static_cast<int>(corners_.size()));
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
    const auto vote = [&](int v, Vector at) {
        sum[v] += Complex(at.x, at.y);
        const double norm = at.norm();
        reach[v] += std::sqrt(norm);
        if (++votes[v] > 1)
            return;
        queue.emplace_back(norm, v);
        std::push_heap(queue.begin(), queue.end(), std::greater<>());
    };
    const auto corners_of = [&](int vertex) {
        return std::span(corners_).subspan(corner_first_[vertex], corner_first_[vertex + 1] - corner_first_[vertex]);
    };
    const auto lay_fan = [&](int vertex) {
        const auto opening = [](const Corner& c) { return std::atan2(c.turn_y, c.turn_x); };
        double total = 0;
        for (const Corner& c : corners_of(vertex)) total += opening(c);
        const double scale = closed_[vertex] && total > 0 ? 2 * std::numbers::pi / total : 1;
        double angle = 0;
        const auto vote_at = [&](int v, double length) {
            if (local[v] != none && !laid[local[v]])
                vote(local[v], length * Vector{std::cos(angle), std::sin(angle)});
        };
        for (const Corner& c : corners_of(vertex)) {
            vote_at(c.target, c.length);
            angle += scale * opening(c);
            if (!closed_[vertex] && &c == &corners_of(vertex).back())
                vote_at(c.third, c.length * Vector{c.turn_x, c.turn_y}.size());
        }
    };
    // Faces of the vertex with one corner left to lay.
    const auto unfold_around = [&](int vertex) {
        const int i = local[vertex];
        for (const Corner& c : corners_of(vertex)) {
            const int j = local[c.target], m = local[c.third];
            if (j == none || m == none || laid[j] == laid[m])
                continue;
            const Vector turn{c.turn_x, c.turn_y};
            const double norm = turn.norm();
            if (!(norm > 0))
                continue;
            if (laid[j])
                vote(m, third_place(plain(place[i]), plain(place[j]), c.length, turn));
            else
                vote(j, third_place(plain(place[i]), plain(place[m]), c.length * std::sqrt(norm), 1 / norm * turn.mirrored()));
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
        if (laid[v])
            continue;
        const double size = plain(sum[v]).size();
        settle(v, size > 0 ? reach[v] / (votes[v] * size) * sum[v] : sum[v]);
    }

    for (std::size_t v = 0; v < count; ++v) {
        if (laid[v])
            continue;
        for (const Corner& c : corners_of(vertices[v]))
            for (int w : {local[c.target], local[c.third]})
                if (w != none && laid[w])
                    place[v] = place[w];
    }
}

}  // namespace pvg
