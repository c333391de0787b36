// Approximate geodesic distances for sampling and for upper bounds: Dijkstra on the edge graph, optionally with the
// straight segments to the vertices across each edge (about 12 directions a vertex: a few per cent too long at most).
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "mesh/surface.h"

namespace pvg {

/// Adjacency in compressed rows: the steps of vertex v are steps[first[v]] .. steps[first[v + 1] - 1].
struct SurfaceGraph {
    struct Step {
        int to;
        double length;
    };
    std::vector<int> first;
    std::vector<Step> steps;
};

/// across: with the segments across edges.
SurfaceGraph surface_graph(const Surface& surface, bool across);

/// Dijkstra fronts on a graph; keeps its queue between calls.
class GraphFront {
public:
    explicit GraphFront(const SurfaceGraph& graph) : graph_(graph) {}

    /// Starts a front at a vertex whose distance is already set.
    void start(int vertex, double distance) { queue_.push_back({distance, vertex}); }

    /// Lowers `distance` outwards. A vertex v reached at d passes it on only where expand(v, d).
    template <typename Expand>
    void spread(std::vector<double>& distance, Expand&& expand) {
        const auto later = [](const std::pair<double, int>& a, const std::pair<double, int>& b) { return a > b; };
        std::make_heap(queue_.begin(), queue_.end(), later);
        while (!queue_.empty()) {
            std::pop_heap(queue_.begin(), queue_.end(), later);
            const auto [reached, v] = queue_.back();
            queue_.pop_back();
            if (reached > distance[v] || !expand(v, reached))
                continue;
            for (int i = graph_.first[v]; i < graph_.first[v + 1]; ++i) {
                const auto& step = graph_.steps[i];
                const double d = reached + step.length;
                if (d >= distance[step.to])
                    continue;
                distance[step.to] = d;
                queue_.push_back({d, step.to});
                std::push_heap(queue_.begin(), queue_.end(), later);
            }
        }
    }

private:
    const SurfaceGraph& graph_;
    std::vector<std::pair<double, int>> queue_;
};

/// Distance of every vertex to the nearest marked one (+infinity where none is reached).
std::vector<double> graph_distance(const SurfaceGraph& graph, const std::vector<char>& marked);

}  // namespace pvg
