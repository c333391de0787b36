// Exact geodesic distances on a triangle surface: window propagation after Chen and Han (1990) with the filter of
// Xin and Wang, "Improving Chen & Han's algorithm on the discrete geodesic problem", ACM TOG 28(4), 2009.
// Saddle vertices, reflex border vertices (so slit tips too) are pseudo-sources.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "mesh/surface.h"

namespace pvg {

/// A source: a point on the surface and the distance it starts with (0 for an ordinary source).
struct GeodesicSource {
    SurfacePoint at;
    double distance = 0;
};

struct GeodesicOptions {
    double max_distance = std::numeric_limits<double>::infinity();  ///< nothing farther is computed
    bool keep_windows = false;          ///< needed by distance_at, path_to, level_set and the Voronoi stage
    std::vector<SurfacePoint> targets;  ///< when not empty: stop as soon as all of these are exact
};

/// A straight bundle of geodesics that enters a face through a halfedge. In the frame of that halfedge (origin at
/// its origin vertex, x along it, y into its face) the (pseudo-)source unfolds to `source`, y <= 0.
struct GeodesicWindow {
    int halfedge = none;      ///< of the face that the bundle enters
    double begin = 0;         ///< interval on the halfedge, 0 <= begin < end <= length
    double end = 0;
    Eigen::Vector2d source{0, 0};
    double offset = 0;        ///< distance of the pseudo-source from its source (0: seen straight from the source)
    int root = none;          ///< index of the source (into the argument of compute)
    double rotation = 0;      ///< angle to add to a direction in this frame to get the angle at the source (see log map); only for offset == 0... for offset > 0 the direction is that of the path's first segment
};

class GeodesicField {
public:
    /// Per vertex: exact distance to the nearest source (+infinity where none reaches, or beyond max_distance).
    std::vector<double> distance;
    /// Per vertex: index of that source, or none. Ties go to the lower index.
    std::vector<int> root;
    /// Per vertex: direction in radians in which the path leaves its source. At a vertex source the angle is measured
    /// counter-clockwise from Surface::outgoing(v) in true face angles (0 .. angle_sum); at a source inside a face from the
    /// face's first edge. Undefined (0) at sources themselves. distance and direction together are the log map.
    std::vector<double> direction;
    /// All windows kept, when asked for, sorted by halfedge; window_first (3F + 1) indexes them.
    std::vector<GeodesicWindow> windows;
    std::vector<std::size_t> window_first;
};

/// Distances from all sources together (Voronoi-like: each vertex keeps its nearest).
/// Requires sources on faces of the surface. O(n^2 log n) worst case, about n^1.5 in practice for one source. Thread-safe for
/// different calls. Deterministic.
GeodesicField geodesic_distances(const Surface& surface, std::span<const GeodesicSource> sources, const GeodesicOptions& options = {});

/// The surface point of a vertex.
SurfacePoint at_vertex(const Surface& surface, int vertex);

}  // namespace pvg
