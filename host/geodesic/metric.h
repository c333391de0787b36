// The intrinsic metric of a surface as flat tables: every face laid out in the plane of each of its halfedges.
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "mesh/surface.h"

namespace pvg {

/// The frame of a halfedge: origin at its origin vertex, x along it, y into its face.
struct HalfedgeFrame {
    double length;
    double inverse;  ///< 1 / length, 0 for a collapsed edge
    double apex_x;   ///< the face's third vertex; apex_y >= 0
    double apex_y;
};

/// Worked out face by face and fan by fan where it is asked for: what stays near its sources costs what is near, however large
/// the surface. Not thread-safe; references stay valid.
class SurfaceMetric {
public:
    explicit SurfaceMetric(const Surface& surface);

    const HalfedgeFrame& frame(int halfedge) {
        if (!known_[halfedge / 3])
            measure(halfedge / 3);
        return frame_[halfedge];
    }
    /// The face's angle at the halfedge's origin.
    double corner_angle(int halfedge) {
        if (!known_[halfedge / 3])
            measure(halfedge / 3);
        return corner_angle_[halfedge];
    }
    /// Direction of a halfedge at its origin, counter-clockwise from outgoing(v).
    double fan_angle(int halfedge) {
        angle_sum(surface_.origin(halfedge));
        return fan_angle_[halfedge];
    }
    double angle_sum(int vertex) {
        if (angle_sum_[vertex] == unknown)
            sweep(vertex);
        return angle_sum_[vertex];
    }
    double perimeter(int face) { return frame(3 * face).length + frame(3 * face + 1).length + frame(3 * face + 2).length; }

private:
    static constexpr double unknown = -1;
    void measure(int face);
    void sweep(int vertex);

    const Surface& surface_;
    std::vector<char> known_;  // per face
    std::vector<double> angle_sum_;
    // Not initialised: pages that no face near a source needs are never touched.
    std::unique_ptr<HalfedgeFrame[]> frame_;
    std::unique_ptr<double[]> corner_angle_, fan_angle_;
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
