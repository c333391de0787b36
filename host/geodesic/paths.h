// Geodesic paths, circles and level sets as chains of surface points.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "geodesic/geodesic.h"
#include "mesh/surface.h"

namespace pvg {

/// A polyline on a surface. Consecutive points lie on one common face (closed), so each piece is a straight segment
/// in it; points are on edges and at vertices where the line changes face, or inside faces where it bends.
struct SurfacePath {
    std::vector<SurfacePoint> points;
    bool closed = false;  ///< the last point joins the first (which is not repeated)
};

double length(const Surface& surface, const SurfacePath& path);

/// A face whose closed triangle contains both points (coordinates up to 1e-12 count as 0), or none.
int common_face(const Surface& surface, const SurfacePoint& a, const SurfacePoint& b);
/// The coordinates of a point in another face that contains it.
Eigen::Vector3d bary_in(const Surface& surface, int face, const SurfacePoint& at);

/// The globally shortest path (exact). Throws Error(bad_input) when the points are on different components.
/// upper_bound: the length of some path between the two, where one is known (a straightened one, say): only the faces that a
/// shorter one can cross are looked at.
SurfacePath shortest_path(const Surface& surface, const SurfacePoint& from, const SurfacePoint& to,
                          double upper_bound = std::numeric_limits<double>::infinity());

/// A locally shortest path: a face strip found by best-first search, pulled straight and straightened around
/// its vertices until no vertex can be passed on a shorter side. Much faster than shortest_path; what splines interpolate along.
/// (Xin and Wang, "Efficiently determining a locally exact shortest path on polyhedral surfaces", CAD 2007;
/// Mancinelli et al., "b/Surf: interactive Bezier splines on surface meshes", TVCG 2022.)
SurfacePath straightened_path(const Surface& surface, const SurfacePoint& from, const SurfacePoint& to);

/// The point at a fraction s in [0, 1] of the path's length.
SurfacePoint point_along(const Surface& surface, const SurfacePath& path, double s);

/// Exact distance at any surface point, from a field computed with keep_windows (+infinity where none reaches).
/// sources: the same that the field was computed from.
double distance_at(const Surface& surface, const GeodesicField& field, std::span<const GeodesicSource> sources,
                   const SurfacePoint& at);

/// The exact path from a surface point back to its source, first point `at`, last the source.
SurfacePath path_to_source(const Surface& surface, const GeodesicField& field, std::span<const GeodesicSource> sources,
                           const SurfacePoint& at);

/// All loops (and border-to-border arcs, closed = false) where the exact distance equals `distance`, the sources on the left.
/// Every crossing of a mesh edge is exact; inside a face arcs are sampled so that a chord is off by at most `tolerance` (mesh
/// units).
std::vector<SurfacePath> level_set(const Surface& surface, const GeodesicField& field, std::span<const GeodesicSource> sources,
                                   double distance, double tolerance);

/// The geodesic circle as one counter-clockwise loop that begins where the direction `start` leaves the centre.
/// Throws Error(bad_input) with the largest radius that works when it is not one closed loop (meets a border, wraps, splits).
SurfacePath geodesic_circle(const Surface& surface, const SurfacePoint& center, double radius, const SurfacePoint& start,
                            double tolerance);

}  // namespace pvg
