// Greedy Poisson-disk sampling in geodesic distance, after Bridson's dart throwing rule without the randomness: vertices
// are tried outwards from the curves, so that rings of knots pack around them.
#include "solve/knots.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "pvg/status.h"
#include "solve/surface_graph.h"

namespace pvg {

namespace {

/// Knots may come this much nearer to each other than one input edge. Imprinting leaves the mesh's own vertices at any distance
/// from a curve; were they not knots, no smooth fit to the knots around would tell them what a field that bends within an edge
/// does there (cpu_reference/ACCURACY.md). As knots they also have the shortest rows.
constexpr double least_edge_share = 0.01;

/// sqrt(curvature / |K|) with K = angle defect / lumped area, growing away from each vertex by the grading. A cone's tip has all
/// its defect in one vertex: it becomes a knot, and sizes grow from there.
std::vector<double> curvature_sizes(const Surface& surface, const SurfaceGraph& graph, const KnotOptions& options) {
    const int vertices = surface.vertex_count();
    std::vector<double> angle(vertices, 0), area(vertices, 0);
    for (int h = 0; h < surface.halfedge_count(); ++h) {
        const int v = surface.origin(h);
        const Point &at = surface.point(v), &ahead = surface.point(surface.target(h)),
                    &back = surface.point(surface.origin(Surface::prev(h)));
        const Point a = ahead - at, b = back - at;
        const double sine = a.cross(b).norm();
        angle[v] += std::atan2(sine, a.dot(b));
        area[v] += sine / 6;
    }
    // In units of grading, so that a front's distance adds to it.
    std::vector<double> reach(vertices, std::numeric_limits<double>::infinity());
    GraphFront front(graph);
    for (int v = 0; v < vertices; ++v) {
        if (surface.outgoing(v) == none || surface.is_border_vertex(v))
            continue;
        const double defect = std::abs(2 * std::numbers::pi - angle[v]);
        const double size = std::sqrt(options.curvature * area[v] / std::max(defect, 1e-12));
        if (size >= options.spacing)
            continue;
        reach[v] = size / options.grading;
        front.start(v, reach[v]);
    }
    front.spread(reach, [&](int, double distance) { return options.grading * distance < options.spacing; });
    for (double& r : reach) r *= options.grading;
    return reach;
}

std::vector<double> knot_sizes(const Domain& domain, const KnotOptions& options, const std::vector<double>& curve_distance,
                               const std::vector<double>& feature_distance, const std::vector<double>& curvature_size) {
    std::vector<double> size(curve_distance.size());
    for (std::size_t v = 0; v < size.size(); ++v) {
        const double least = least_edge_share * std::min(domain.edge_length[v], options.spacing);
        const double wanted =
            std::min({options.grading * curve_distance[v], options.feature_grading * feature_distance[v], curvature_size[v]});
        const double most = std::min(options.spacing, options.most_edges * domain.edge_length[v]);
        size[v] = std::clamp(wanted, std::min(least, most), most);
    }
    return size;
}

}  // namespace

Knots place_knots(const Domain& domain, const KnotOptions& options) {
    if (!(options.spacing > 0) || !(options.grading > 0) || !(options.feature_grading > 0))
        throw Error(ErrorKind::bad_input, "knots: spacing and grading must be above 0");
    const Surface& surface = domain.surface;
    const int vertices = surface.vertex_count();
    const SurfaceGraph graph = surface_graph(surface, true);
    const std::vector<double> curve_distance = graph_distance(graph, domain.on_curve);
    const std::vector<double> size = knot_sizes(domain, options, curve_distance, graph_distance(graph, domain.feature),
                                                curvature_sizes(surface, graph, options));

    std::vector<char> chosen(vertices, 0);
    std::vector<double> free_distance(vertices, std::numeric_limits<double>::infinity());  // to the nearest knot so far
    GraphFront front(graph);
    // A knot blocks vertices nearer than their size; sizes grow slower than distance, so fronts need not go past them.
    const auto blocks = [&](int v, double reached) { return reached < size[v]; };
    for (int v = 0; v < vertices; ++v)
        if (domain.on_curve[v] || surface.is_border_vertex(v)) {
            chosen[v] = 1;
            free_distance[v] = 0;
            front.start(v, 0);
        }
    front.spread(free_distance, blocks);

    std::vector<int> order;
    order.reserve(vertices);
    for (int v = 0; v < vertices; ++v)
        if (!chosen[v] && surface.outgoing(v) != none)
            order.push_back(v);
    std::sort(order.begin(), order.end(), [&](int a, int b) {
        return curve_distance[a] != curve_distance[b] ? curve_distance[a] < curve_distance[b] : a < b;
    });
    for (int v : order) {
        if (free_distance[v] < size[v])
            continue;
        chosen[v] = 1;
        free_distance[v] = 0;
        front.start(v, 0);
        front.spread(free_distance, blocks);
    }

    Knots knots;
    knots.knot_of_vertex.assign(vertices, none);
    for (int v = 0; v < vertices; ++v)
        if (chosen[v]) {
            knots.knot_of_vertex[v] = static_cast<int>(knots.vertex.size());
            knots.vertex.push_back(v);
        }
    return knots;
}

}  // namespace pvg
