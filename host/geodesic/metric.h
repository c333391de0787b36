// The intrinsic metric of a surface as flat tables: every face laid out in the plane of each of its halfedges.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "mesh/surface.h"

namespace pvg {

/// The frame of a halfedge: origin at its origin vertex, x along it, y into its face.
struct HalfedgeFrame {
    double length = 0;
    double inverse = 0;  ///< 1 / length, 0 for a collapsed edge
    double apex_x = 0;   ///< the face's third vertex; apex_y >= 0
    double apex_y = 0;
};

struct SurfaceMetric {
    explicit SurfaceMetric(const Surface& surface);

    std::vector<HalfedgeFrame> frame;  ///< per halfedge
    std::vector<double> corner_angle;  ///< per halfedge: the face's angle at its origin
    std::vector<double> fan_angle;     ///< per halfedge: its direction at its origin, counter-clockwise from outgoing(v)
    std::vector<double> angle_sum;     ///< per vertex

    double perimeter(int face) const { return frame[3 * face].length + frame[3 * face + 1].length + frame[3 * face + 2].length; }
};

HalfedgeFrame halfedge_frame(const Surface& surface, int halfedge);

/// Coordinates of a point of the halfedge's face in the halfedge's frame, and back.
Eigen::Vector2d to_frame(const HalfedgeFrame& frame, int halfedge, const Eigen::Vector3d& bary);
SurfacePoint from_frame(const HalfedgeFrame& frame, int halfedge, const Eigen::Vector2d& at);

/// Where a surface point lies: at a vertex (vertex != none), else on an edge (halfedge != none, of its face), else inside.
struct Place {
    int vertex = none;
    int halfedge = none;
};
/// Barycentric coordinates below 1e-12 count as 0.
Place place_of(const Surface& surface, const SurfacePoint& at);

/// Throws Error(bad_input) when the face does not exist or the coordinates are not barycentric; `what` names the point.
void check_point(const Surface& surface, const SurfacePoint& at, const char* what);

}  // namespace pvg
