// Which coefficients a patch's rows may use: the list of the knots around, and of the sources that reach in.
#include "solve/patch.h"

#include <algorithm>
#include <functional>
#include <limits>

namespace pvg {

/// Brings those to the front that, one after another, are farthest from all chosen before, as seen from the cell's knot.
/// Distances go from cell to cell, so that the two sides of a slit are apart; the copies on a Poisson curve go together.
void PatchSolver::spread(std::vector<Candidate>& candidates, int wanted) const {
    const int count = static_cast<int>(candidates.size());
    const auto vertex = [&](int i) { return space_.knots.vertex[candidates[i].knot]; };
    std::vector<std::pair<int, int>> by_knot(count);
    for (int i = 0; i < count; ++i) by_knot[i] = {candidates[i].knot, i};
    std::sort(by_knot.begin(), by_knot.end());
    const auto find = [&](int knot) {
        const auto it = std::lower_bound(by_knot.begin(), by_knot.end(), std::pair(knot, 0));
        return it != by_knot.end() && it->first == knot ? it->second : none;
    };
    std::vector<double> gap(count, std::numeric_limits<double>::infinity()), distance(count);
    std::vector<char> chosen(count, 0);
    std::vector<Candidate> order;
    using Entry = std::pair<double, int>;
    std::vector<Entry> heap;
    const auto choose = [&](int i) {
        chosen[i] = 1;
        order.push_back(candidates[i]);
        std::fill(distance.begin(), distance.end(), std::numeric_limits<double>::infinity());
        distance[i] = 0;
        heap.assign(1, {0.0, i});
        while (!heap.empty()) {
            std::pop_heap(heap.begin(), heap.end(), std::greater<>());
            const auto [d, at] = heap.back();
            heap.pop_back();
            if (d > distance[at])
                continue;
            const int knot = candidates[at].knot;
            for (int e = space_.neighbour_first[knot]; e < space_.neighbour_first[knot + 1]; ++e) {
                const int other = find(space_.neighbours[e]);
                if (other == none)
                    continue;
                const double to = d + std::abs(place_[local_[vertex(other)]] - place_[local_[vertex(at)]]);
                if (to >= std::min(distance[other], gap[other]))
                    continue;
                distance[other] = to;
                heap.emplace_back(to, other);
                std::push_heap(heap.begin(), heap.end(), std::greater<>());
            }
        }
        for (int k = 0; k < count; ++k) gap[k] = std::min(gap[k], distance[k]);
    };
    const auto choose_copies = [&](int i) {
        choose(i);
        for_copies(local_[vertex(i)], [&](int copy) {
            const int knot = space_.knots.knot_of_vertex[vertices_[copy]], other = knot == none ? none : find(knot);
            if (other != none && !chosen[other])
                choose(other);
        });
    };
    choose_copies(0);
    // Across a sharp Poisson curve the field is known as far as its jump is: without a listed couple the knots beyond would count
    // as if there were none. Two couples tell how it goes on along the curve.
    std::vector<int> coupled;
    for (int i = 1; i < count; ++i)
        if (space_.partner[vertex(i)] != none)
            coupled.push_back(i);
    std::stable_sort(coupled.begin(), coupled.end(),
                     [&](int a, int b) { return candidates[a].distance < candidates[b].distance; });
    int couples = 2;
    for (int i : coupled) {
        if (couples == 0)
            break;
        if (chosen[i])
            continue;
        choose_copies(i);
        --couples;
    }
    while (static_cast<int>(order.size()) < wanted) {
        int best = none;
        double most = -1;
        for (int i = 0; i < count; ++i) {
            const double seen = candidates[i].distance > 0 ? gap[i] / candidates[i].distance : 0;
            if (chosen[i] || seen <= most)
                continue;
            best = i;
            most = seen;
        }
        if (best == none)
            break;
        choose_copies(best);
    }
    for (int i = 0; i < count; ++i)
        if (!chosen[i])
            order.push_back(candidates[i]);
    candidates = std::move(order);
}

/// Cuts to at most `room`, in order. The copies of a vertex on sharp Poisson curves stay or go as one: a lone one would bring the
/// field of its side without the jump to it, and which of two equally near ones stays would be up to their numbers.
void PatchSolver::keep_copies_together(std::vector<Candidate>& candidates, int room) const {
    const int count = static_cast<int>(candidates.size());
    if (count <= room)
        return;
    std::vector<std::pair<int, int>> by_vertex(count);
    for (int i = 0; i < count; ++i) by_vertex[i] = {local_[space_.knots.vertex[candidates[i].knot]], i};
    std::sort(by_vertex.begin(), by_vertex.end());
    std::vector<char> seen(count, 0);
    std::vector<Candidate> kept;
    std::vector<int> copies;
    for (int i = 0; i < count; ++i) {
        if (seen[i])
            continue;
        copies.assign(1, i);
        for_copies(local_[space_.knots.vertex[candidates[i].knot]], [&](int copy) {
            const auto at = std::lower_bound(by_vertex.begin(), by_vertex.end(), std::pair(copy, 0));
            if (at != by_vertex.end() && at->first == copy)
                copies.push_back(at->second);
        });
        for (int k : copies) seen[k] = 1;
        if (i == 0 || static_cast<int>(kept.size() + copies.size()) <= room)
            for (int k : copies) kept.push_back(candidates[k]);
    }
    candidates = std::move(kept);
}

/// Knots of the inner rings, nearest first, then the sources of the patch; cut to the longest list allowed.
void PatchSolver::choose_list(Patch& patch) {
    std::vector<Candidate> candidates;
    for (int c : cells_) {
        const int v = local_[space_.knots.vertex[c]];
        if (v != none && ring_of_cell_[c] <= options_.rings)
            candidates.push_back({ring_of_cell_[c], std::abs(place_[v]), c});
    }
    // Points split into the border join a vertex to both sides of a sharp Poisson curve at once, so that one copy may be within
    // reach and the other not.
    for (std::size_t i = 0, reached = candidates.size(); i < reached; ++i) {
        const Candidate candidate = candidates[i];
        for_copies(local_[space_.knots.vertex[candidate.knot]], [&](int copy) {
            const int knot = space_.knots.knot_of_vertex[vertices_[copy]];
            if (knot != none && ring_of_cell_[knot] > options_.rings) {
                ring_of_cell_[knot] = options_.rings;
                candidates.push_back({options_.rings, std::abs(place_[copy]), knot});
            }
        });
    }
    std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
        if (a.ring != b.ring)
            return a.ring < b.ring;
        return a.distance != b.distance ? a.distance < b.distance : a.knot < b.knot;
    });
    std::vector<int> sources;
    for (int v : vertices_)
        for (int i = space_.load_first[v]; i < space_.load_first[v + 1]; ++i) sources.push_back(space_.loads[i].first);
    std::sort(sources.begin(), sources.end());
    sources.erase(std::unique(sources.begin(), sources.end()), sources.end());

    // Padding costs as much as a knot: give up to three knots away for it. Eight must stay, whatever the sources take.
    const int inner = static_cast<int>(candidates.size()), others = static_cast<int>(sources.size());
    const int all = inner + others;
    const int wanted = all > options_.list ? options_.list : all >= options_.round_down ? all / 4 * 4 : all;
    const int room = std::min(std::max(wanted - others, 8), inner);
    if (inner > room + 3)
        spread(candidates, room);
    keep_copies_together(candidates, room);
    patch.list.clear();
    patch.rows.clear();
    patch.distance.clear();
    patch.radius = 0;
    entry_.assign(vertices_.size(), none);
    for (int i = 0; i < static_cast<int>(candidates.size()); ++i) {
        const Candidate& candidate = candidates[i];
        entry_[local_[space_.knots.vertex[candidate.knot]]] = i;
        patch.list.push_back(candidate.knot);
        patch.rows.push_back(space_.knots.vertex[candidate.knot]);
        patch.distance.push_back(candidate.distance);
        patch.radius = std::max(patch.radius, candidate.distance);
    }
    scale_ = patch.radius > 0 ? patch.radius : 1;
    patch.list_knots = static_cast<int>(candidates.size());
    for (int s : sources) patch.list.push_back(static_cast<int>(space_.knots.vertex.size()) + s);
}

}  // namespace pvg
