// Curves on a surface from control points that are surface points: geodesic polylines, B-splines, Bezier chains, circles. Splines
// are evaluated with geodesic interpolation in place of the linear one (de Casteljau; Morera, Velho and Carvalho, "Subdivision
// curves on triangular meshes", CLEI 2008; Mancinelli et al., "b/Surf: interactive Bezier splines on surface meshes", TVCG 2022).
#pragma once

#include <span>
#include <vector>

#include "geodesic/paths.h"
#include "mesh/surface.h"

namespace pvg {

/// A path and each of its points' parameter, ascending in [0, 1] (closed: the first has 0, the way back to it ends at 1).
struct SampledCurve {
    SurfacePath path;
    std::vector<double> t;
};

struct CurveOptions {
    bool closed = false;
    bool parameter_curve = false;  ///< t = (segment + local t) / segments; else by arc length
    double tolerance = 0;  ///< how far a chord may be from the curve, mesh units; 0: 0.05 x the local edge length, and at most
                           ///< 1/200 of the segment's control polygon (of a circle's radius)
};

/// Exact shortest paths from point to point. At least 2 points (closed: 3).
SampledCurve polyline_curve(const Surface& surface, std::span<const SurfacePoint> points, const CurveOptions& options = {});

/// Uniform knots, clamped if open, periodic if closed (the first point is not repeated). degree 1..7; at least degree + 1 points
/// (closed: 3). Converted to Bezier segments, so it is C1 where it passes from one to the next. A closed one of odd degree begins
/// nearest to its first control point.
SampledCurve bspline_curve(const Surface& surface, std::span<const SurfacePoint> points, int degree,
                           const CurveOptions& options = {});

/// A chain of Bezier segments: segments x degree + 1 points, closed: segments x degree (the first point ends the last segment).
SampledCurve bezier_curve(const Surface& surface, std::span<const SurfacePoint> points, int degree,
                          const CurveOptions& options = {});

/// The geodesic circle, counter-clockwise, t by arc length from the direction towards `start`.
SampledCurve circle_curve(const Surface& surface, const SurfacePoint& center, double radius, const SurfacePoint& start,
                          const CurveOptions& options = {});

/// The point at a fraction s in [0, 1] of the straightened geodesic.
SurfacePoint geodesic_interpolation(const Surface& surface, const SurfacePoint& from, const SurfacePoint& to, double s);

}  // namespace pvg
