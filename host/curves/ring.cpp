#include "curves/ring.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "curves/offset.h"
#include "curves/level_outside.h"
#include "curves/patch_poisson.h"
#include "curves/region.h"
#include "curves/slit.h"
#include "pvg/status.h"

namespace pvg {
namespace {

/// Sources on the region's side of its border, in the region's own surface.
std::vector<SourceEdge> border_edges(const SlitSurface& region, const Surface& drawn, const CurveChain& border) {
    std::vector<char> on_border(drawn.halfedge_count(), 0);
    mark_chain(drawn, border, on_border);
    std::vector<SourceEdge> edges;
    for (int h = 0; h < region.surface.halfedge_count(); ++h)
        if (on_border[3 * region.face_parent[h / 3] + h % 3])
            edges.push_back({h, 0, 0, 0});
    return edges;
}

/// The ring cut into pieces, one per stretch of the inner border.
struct Ring {
    SlitSurface part;               ///< the ring's faces
    std::vector<int> face_piece;    ///< per face of part, or none
    std::vector<int> vertex_piece;  ///< per vertex of the imprinted surface that the ring touches, or none
    std::vector<double> charge;     ///< per piece: integral of f2
    std::vector<double> area;       ///< per piece
    double width = 0;               ///< mean
};

/// Runs of inner-border vertices at least `target` long, numbered along the chains. Returns the stretch of each vertex (none
/// elsewhere).
std::vector<int> stretches(const Surface& surface, const std::vector<CurveChain>& inner, double target, int* count) {
    std::vector<int> stretch(surface.vertex_count(), none);
    *count = 0;
    for (const CurveChain& chain : inner) {
        const std::size_t size = chain.vertices.size();
        double total = 0;
        for (std::size_t i = 0; i + (chain.closed ? 0 : 1) < size; ++i)
            total += (surface.point(chain.vertices[(i + 1) % size]) - surface.point(chain.vertices[i])).norm();
        const int pieces = std::max(1, static_cast<int>(std::floor(total / target)));
        double at = 0;
        for (std::size_t i = 0; i < size; ++i) {
            if (i > 0)
                at += (surface.point(chain.vertices[i]) - surface.point(chain.vertices[i - 1])).norm();
            const int piece = std::min(pieces - 1, static_cast<int>(at / total * pieces));
            if (stretch[chain.vertices[i]] == none)
                stretch[chain.vertices[i]] = *count + piece;
        }
        *count += pieces;
    }
    return stretch;
}

Ring split_ring(const Surface& imprinted, const std::vector<char>& faces, const std::vector<CurveChain>& inner) {
    Ring ring;
    ring.part = slit_surface(imprinted, {}, faces);
    const Surface& surface = ring.part.surface;
    // A stretch is about half as long as the ring is wide (shorter ones cannot steer the flux much finer), and never below two
    // edges.
    double ring_area = 0, inner_length = 0;
    int inner_edges = 0;
    for (int f = 0; f < surface.face_count(); ++f) ring_area += surface.face_area(f);
    for (const CurveChain& chain : inner)
        for (const ChainEdge& edge : chain_edges(imprinted, chain)) {
            inner_length += imprinted.length(edge.left != none ? edge.left : edge.right);
            ++inner_edges;
        }
    ring.width = ring_area / inner_length;
    int count = 0;
    const std::vector<int> stretch =
        stretches(imprinted, inner, std::max(0.5 * ring.width, 2 * inner_length / inner_edges), &count);

    std::vector<GeodesicSource> sources;
    std::vector<int> source_stretch;
    for (int v = 0; v < surface.vertex_count(); ++v)
        if (stretch[ring.part.vertex_parent[v]] != none) {
            sources.push_back({at_vertex(surface, v), 0});
            source_stretch.push_back(stretch[ring.part.vertex_parent[v]]);
        }
    const GeodesicField field = geodesic_distances(surface, sources);
    ring.vertex_piece.assign(imprinted.vertex_count(), none);
    for (int v = 0; v < surface.vertex_count(); ++v)
        if (field.root[v] != none)
            ring.vertex_piece[ring.part.vertex_parent[v]] = source_stretch[field.root[v]];
    ring.face_piece.assign(surface.face_count(), none);
    ring.area.assign(count, 0.0);
    for (int f = 0; f < surface.face_count(); ++f) {
        const auto& [a, b, c] = surface.face(f);
        const Point centroid = (surface.point(a) + surface.point(b) + surface.point(c)) / 3;
        const std::array<int, 3> roots{field.root[a], field.root[b], field.root[c]};
        const int root = nearest_of(surface, sources, roots, centroid);
        if (root == none)
            continue;
        ring.face_piece[f] = source_stretch[root];
        ring.area[ring.face_piece[f]] += surface.face_area(f);
    }
    // A stretch that no face is nearest to joins the one before it.
    std::vector<int> renumbered(count);
    int kept = none;
    for (int s = 0; s < count; ++s)
        if (ring.area[s] > 0 || kept != none)
            renumbered[s] = ring.area[s] > 0 ? ++kept : kept;
        else
            renumbered[s] = 0;
    for (int& piece : ring.face_piece)
        if (piece != none)
            piece = renumbered[piece];
    for (int& piece : ring.vertex_piece)
        if (piece != none)
            piece = renumbered[piece];
    for (int s = 0; s < count; ++s)
        if (ring.area[s] > 0)
            ring.area[renumbered[s]] = ring.area[s];
    ring.area.resize(kept + 1);
    ring.charge.assign(kept + 1, 0.0);
    return ring;
}

}  // namespace

std::vector<SurfacePath> ring_borders(const Surface& drawn, const CurveChain& border, double ring, double* ring_width) {
    const SlitSurface region = slit_surface(drawn, {}, faces_inside(drawn, border));
    const std::vector<SourceEdge> edges = border_edges(region, drawn, border);
    GeodesicOptions options;
    const CurveSources coarse = sources_along(region.surface, edges, std::numeric_limits<double>::infinity());
    double largest = 0, longest_edge = 0;
    for (double d : geodesic_distances(region.surface, coarse.sources, options).distance)
        if (std::isfinite(d))
            largest = std::max(largest, d);
    for (int h = 0; h < region.surface.halfedge_count(); ++h) longest_edge = std::max(longest_edge, region.surface.length(h));
    // In coarse regions no vertex may lie off the border: there the faces tell.
    options.keep_windows = true;
    if (largest < 2 * longest_edge)
        largest = largest_distance(region.surface, geodesic_distances(region.surface, coarse.sources, options), coarse.sources);
    // Offsets off by (0.1 w)^2 / 8 w = 0.1 % of the width.
    const CurveSources fine = sources_along(region.surface, edges, 0.1 * ring * largest);
    const GeodesicField field = geodesic_distances(region.surface, fine.sources, options);
    const double width = ring * largest_distance(region.surface, field, fine.sources);
    if (ring_width)
        *ring_width = width;
    std::vector<SurfacePath> paths;
    for (SurfacePath& path : level_set(region.surface, field, fine.sources, width, 0.005 * width)) {
        for (SurfacePoint& at : path.points) at.face = region.face_parent[at.face];
        paths.push_back(std::move(path));
    }
    if (paths.empty())
        throw Error(ErrorKind::bad_input, "the region is too small for its ring: no curve lies at that distance from the border");
    return paths;
}

std::vector<std::pair<int, double>> region_profile(const Surface& imprinted, const CurveChain& border,
                                                   const std::vector<CurveChain>& inner, double* peak) {
    const std::vector<char> inside = faces_inside(imprinted, border);
    std::vector<char> on_border(imprinted.halfedge_count(), 0);
    mark_chain(imprinted, border, on_border);
    const SlitSurface region = slit_surface(imprinted, {}, inside);
    const PatchPoisson own(region, imprinted.vertex_count(), on_border);
    std::vector<double> laplacian(region.surface.face_count(), 1.0);
    if (!inner.empty()) {
        std::vector<char> barrier = on_border;
        for (const CurveChain& chain : inner) mark_chain(imprinted, chain, barrier);
        std::vector<int> seeds;
        for (int h = 0; h < imprinted.halfedge_count(); ++h)
            if (on_border[h] && inside[h / 3])
                seeds.push_back(h / 3);
        const std::vector<char> ring_faces = flood_faces(imprinted, barrier, seeds);
        std::vector<char> inner_faces(imprinted.face_count(), 0);
        for (int f = 0; f < imprinted.face_count(); ++f) inner_faces[f] = inside[f] && !ring_faces[f];
        const SlitSurface core = slit_surface(imprinted, {}, inner_faces);
        if (core.surface.face_count() == 0)
            throw Error(ErrorKind::bad_input, "the region's ring leaves no inside; expected a smaller ring");

        Ring ring = split_ring(imprinted, ring_faces, inner);
        const PatchPoisson problem(core, imprinted.vertex_count(), barrier);
        const Eigen::VectorXd load = problem.load_of(std::vector<double>(core.surface.face_count(), 1.0));
        const Eigen::VectorXd flux = problem.flux(problem.solve(load), load);
        for (int v = 0; v < imprinted.vertex_count(); ++v)
            if (ring.vertex_piece[v] != none && problem.vertex_of(v) != none)
                ring.charge[ring.vertex_piece[v]] -= flux[problem.vertex_of(v)];
        std::vector<double> ring_laplacian(imprinted.face_count(), 0.0);
        for (int f = 0; f < ring.part.surface.face_count(); ++f)
            if (const int piece = ring.face_piece[f]; piece != none)
                ring_laplacian[ring.part.face_parent[f]] = ring.charge[piece] / ring.area[piece];
        std::vector<char> adjustable(region.surface.face_count(), 0);
        for (int f = 0; f < region.surface.face_count(); ++f) {
            adjustable[f] = ring_faces[region.face_parent[f]];
            if (adjustable[f])
                laplacian[f] = ring_laplacian[region.face_parent[f]];
        }
        const std::vector<double> change = level_outside(own, ring.width, adjustable, own.load_of(laplacian));
        double total = 0, ring_area = 0;
        for (int f = 0; f < region.surface.face_count(); ++f) {
            laplacian[f] += change[f];
            total += laplacian[f] * region.surface.face_area(f);
            if (adjustable[f])
                ring_area += region.surface.face_area(f);
        }
        // What is left of the sum is rounding and the tolerance of the change; make it 0.
        for (int f = 0; f < region.surface.face_count(); ++f)
            if (adjustable[f])
                laplacian[f] -= total / ring_area;
    }
    if (peak)
        *peak = own.solve(own.load_of(laplacian)).cwiseAbs().maxCoeff();
    std::vector<std::pair<int, double>> profile;
    for (int f = 0; f < region.surface.face_count(); ++f)
        if (laplacian[f] != 0)
            profile.emplace_back(region.face_parent[f], laplacian[f]);
    return profile;
}

}  // namespace pvg
