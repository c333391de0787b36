// Exact geodesic distances on a triangle surface: window propagation after Chen and Han (1990) with the filter of
// Xin and Wang, "Improving Chen & Han's algorithm on the discrete geodesic problem", ACM TOG 28(4), 2009.
// Saddle vertices, reflex border vertices (so slit tips too) are pseudo-sources.
#pragma once

#include <limits>
#include <optional>
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
    bool keep_windows = false;  ///< needed by distance_at, path_to_source, level_set and the Voronoi stage
    double keep_beyond = 0;     ///< keep only windows of faces that reach this distance or more: all that a level set needs
    std::vector<SurfacePoint>
        targets;  ///< when not empty: stop as soon as all of these are exact; elsewhere distances are upper bounds
    /// With max_distance: only what can lie on a path of that length to this point in space is computed, so that one target costs
    /// the faces of an ellipse. Distances are then exact at that target alone.
    std::optional<Point> toward;
};

/// A straight bundle of geodesics that enters a face through a halfedge. In the frame of that halfedge (origin at
/// its origin vertex, x along it, y into its face) the (pseudo-)source unfolds to `source`, y <= 0. A point p of the face whose
/// segment to `source` crosses the halfedge within [begin, end] can be reached along it, at distance offset + |p - source|.
struct GeodesicWindow {
    int halfedge = none;  ///< of the face that the bundle enters
    double begin = 0;     ///< interval on the halfedge, 0 <= begin < end <= length
    double end = 0;
    Eigen::Vector2d source{0, 0};
    double offset = 0;  ///< distance that `source` starts with: of the pseudo-source from its source, or GeodesicSource::distance
    int root = none;    ///< index of the source (into the argument of compute)
    int via = none;     ///< the pseudo-source vertex that the bundle leaves from; none: it leaves from the source itself
    /// Log map. via == none: rotation + atan2(y, x) of the vector source -> p in the halfedge's frame (atan2 in [0, pi]) is the
    /// direction at the source. via != none: rotation itself is the direction, that of the path's first segment. Neither is
    /// reduced to a full turn.
    double rotation = 0;
};

/// What geodesic_distances finds. Paths that lie in one face only pass no window. So whoever needs the distance INSIDE a face
/// takes the minimum over
///   - the windows that enter it through its three halfedges,
///   - its three corners v where is_source[v] or is_pseudo_source[v] holds: distance[v] + |p - v| (for the other corners that is
///   still an upper
///     bound, but never needed),
///   - sources inside the face or on its edges: GeodesicSource::distance + |p - source|.
/// distance_at (paths.h) does so.
class GeodesicField {
public:
    /// Per vertex: exact distance to the nearest source (+infinity where none reaches, or beyond max_distance).
    std::vector<double> distance;
    /// Per vertex: index of that source, or none. Ties go to the lower index.
    std::vector<int> root;
    /// Per vertex: direction in radians in which the path leaves its source. At a vertex source the angle is measured
    /// counter-clockwise from Surface::outgoing(v) in true face angles (0 .. angle_sum); at a source inside a face or on an edge
    /// from the first edge of GeodesicSource::at.face. Undefined (0) at sources themselves. distance and direction together are
    /// the log map.
    std::vector<double> direction;
    /// Per vertex: direction, measured at this vertex from outgoing(v), of the path back to its source, and the pseudo-source
    /// vertex where that first straight piece of the way back ends (none: it reaches the source).
    std::vector<double> arrival;
    std::vector<int> via;
    /// Per vertex: 1 where a source stands that is its own nearest.
    std::vector<char> is_source;
    /// Per vertex: 1 where shortest paths may bend and one arrives: angle sum > 2 pi inside, > pi on a border (slit tips too).
    std::vector<char> is_pseudo_source;
    /// All windows kept, when asked for, sorted by halfedge; window_first (3F + 1) indexes them. Together with corners and
    /// sources (above) they cover every shortest path; they overlap, and some are nowhere the nearest.
    std::vector<GeodesicWindow> windows;
    std::vector<std::size_t> window_first;
};

/// Distances from all sources together (Voronoi-like: each vertex keeps its nearest).
/// Requires sources on faces of the surface (Error(bad_input) otherwise). O(n^2 log n) worst case, about n^1.5 in practice for
/// one source. Thread-safe for different calls. Deterministic.
GeodesicField geodesic_distances(const Surface& surface, std::span<const GeodesicSource> sources,
                                 const GeodesicOptions& options = {});

/// The surface point of a vertex.
SurfacePoint at_vertex(const Surface& surface, int vertex);

}  // namespace pvg
