// The distance function inside one face, as the least of finitely many cones: |p - center| + offset over a wedge of the face.
// Every window that enters the face gives one, and so do the (pseudo-)sources at its corners and the sources inside it or on its
// edges.
#pragma once

#include <array>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "geodesic/geodesic.h"
#include "geodesic/metric.h"

namespace pvg {

/// All coordinates are in the frame of the face's first halfedge.
struct Cone {
    Eigen::Vector2d center{0, 0};
    double offset = 0;
    int root = none;
    int vertex =
        none;  ///< the vertex that the straight piece of the path leaves from; none: a source inside a face or on an edge
    bool straight =
        false;  ///< seen straight from the source: the direction there is rotation + the angle of p - center. Else it is rotation
    double rotation = 0;
    bool wedge = false;  ///< only between the rays from center through left and right
    Eigen::Vector2d left{0, 0}, right{0, 0};
    int halfedge = none;  ///< that the bundle enters through; none: the center is in the face

    double value(const Eigen::Vector2d& p) const { return offset + (p - center).norm(); }
    /// Is p in the wedge, give or take `slack` radians?
    bool covers(const Eigen::Vector2d& p, double slack) const;
};

class FaceCones {
public:
    /// Refers to its arguments; needs field.windows (Error(bad_input) without).
    FaceCones(const Surface& surface, const GeodesicField& field, std::span<const GeodesicSource> sources);

    /// Whether anything reaches the face; where nothing does, at(face) is empty.
    bool reached(int face) const;
    /// The cones of a face.
    const std::vector<Cone>& at(int face);
    /// The face laid out: its corners.
    const std::array<Eigen::Vector2d, 3>& corners() const { return corners_; }

    /// The index in at(face) of the cone that is least at a point of that face, or none; and its value there.
    int nearest(int face, const Eigen::Vector2d& p, double* value = nullptr) const;

    static constexpr double slack = 1e-7;  ///< see reach_angle in geodesic.cpp; wrong by its square only

private:
    void lay_out(int face);

    const Surface& surface_;
    const GeodesicField& field_;
    std::span<const GeodesicSource> sources_;
    std::vector<std::pair<int, int>>
        inner_;  ///< (face, source) for sources that are not at vertices, sorted; edges on both sides
    int face_ = none;
    std::array<HalfedgeFrame, 3> frame_;
    std::array<Eigen::Vector2d, 3> corners_;
    std::array<double, 3> turn_{};  ///< angle of each halfedge in the first one's frame
    std::vector<Cone> cones_;
};

/// Direction of a halfedge at its origin v, counter-clockwise from outgoing(v). O(valence).
double fan_angle(const Surface& surface, int halfedge);

}  // namespace pvg
