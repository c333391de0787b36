// Greedy Poisson-disk sampling in geodesic distance, after Bridson's dart throwing rule without the randomness: vertices
// are tried outwards from the curves, so that rings of knots pack around them.
#include "solve/knots.h"

#include <algorithm>
#include <limits>

#include "pvg/status.h"
#include "solve/surface_graph.h"

namespace pvg {

namespace {

/// Near features and where sources act, knots may come this much nearer to each other than one input edge. On an irregular
/// mesh the first vertices around a tip are between half an edge and one and a half away, and the whole field's accuracy hangs
/// on knots there (a factor of two in the mean error). Rings and strips are often only one or two edges wide: with the first
/// row a whole edge away, long cells reach from one border to the other across a field that bends (1.9 % off instead of 0.4).
constexpr double fine_row = 0.5;

/// Vertices of faces with a Laplacian.
std::vector<char> source_vertices(const Domain& domain) {
    std::vector<char> marked(domain.surface.vertex_count(), 0);
    for (const SourceColumn& source : domain.sources)
        for (const auto& [face, laplacian] : source.profile)
            if (laplacian != 0)
                for (int v : domain.surface.face(face)) marked[v] = 1;
    return marked;
}

std::vector<double> knot_sizes(const Domain& domain, const KnotOptions& options, const std::vector<double>& curve_distance,
                               const std::vector<double>& feature_distance) {
    const std::vector<char> in_source = source_vertices(domain);
    std::vector<double> size(curve_distance.size());
    for (std::size_t v = 0; v < size.size(); ++v) {
        const double to_feature = options.feature_grading * feature_distance[v];
        const double edge = std::min(domain.edge_length[v], options.spacing);
        const double least = in_source[v] ? fine_row * edge : std::clamp(to_feature, fine_row * edge, edge);
        size[v] = std::max(least, std::min({options.spacing, options.grading * curve_distance[v], to_feature}));
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
    const std::vector<double> size = knot_sizes(domain, options, curve_distance, graph_distance(graph, domain.feature));

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
