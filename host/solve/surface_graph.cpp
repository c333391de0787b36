#include "solve/surface_graph.h"

#include <cmath>
#include <limits>

namespace pvg {

SurfaceGraph surface_graph(const Surface& surface, bool across) {
    struct Link {
        int a, b;
        double length;
    };
    std::vector<Link> links;
    links.reserve(static_cast<std::size_t>(surface.halfedge_count()) * (across ? 2 : 1));
    for (int h = 0; h < surface.halfedge_count(); ++h) {
        const int other = surface.twin(h);
        if (other != none && other < h)
            continue;
        const int from = surface.origin(h), to = surface.target(h);
        const Point edge = surface.point(to) - surface.point(from);
        const double length = edge.norm();
        links.push_back({from, to, length});
        if (!across || other == none || !(length > 0))
            continue;
        const int left = surface.origin(Surface::prev(h)), right = surface.origin(Surface::prev(other));
        if (left == right)
            continue;
        // Both apexes unfolded into the plane of the edge; the segment between them counts only where it crosses the edge.
        const Point to_left = surface.point(left) - surface.point(from), to_right = surface.point(right) - surface.point(from);
        const double x_left = to_left.dot(edge) / length, y_left = to_left.cross(edge).norm() / length;
        const double x_right = to_right.dot(edge) / length, y_right = to_right.cross(edge).norm() / length;
        if (!(y_left + y_right > 0))
            continue;
        const double crossing = (x_left * y_right + x_right * y_left) / (y_left + y_right);
        if (crossing > 0 && crossing < length)
            links.push_back({left, right, std::hypot(x_left - x_right, y_left + y_right)});
    }
    SurfaceGraph graph;
    graph.first.assign(surface.vertex_count() + 1, 0);
    for (const Link& link : links) {
        ++graph.first[link.a + 1];
        ++graph.first[link.b + 1];
    }
    for (int v = 0; v < surface.vertex_count(); ++v) graph.first[v + 1] += graph.first[v];
    graph.steps.resize(2 * links.size());
    std::vector<int> end(graph.first.begin(), graph.first.end() - 1);
    for (const Link& link : links) {
        graph.steps[end[link.a]++] = {link.b, link.length};
        graph.steps[end[link.b]++] = {link.a, link.length};
    }
    return graph;
}

std::vector<double> graph_distance(const SurfaceGraph& graph, const std::vector<char>& marked) {
    std::vector<double> distance(marked.size(), std::numeric_limits<double>::infinity());
    GraphFront front(graph);
    for (std::size_t v = 0; v < marked.size(); ++v)
        if (marked[v]) {
            distance[v] = 0;
            front.start(static_cast<int>(v), 0);
        }
    front.spread(distance, [](int, double) { return true; });
    return distance;
}

}  // namespace pvg
