#include "geodesic/metric.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "pvg/status.h"

namespace pvg {

HalfedgeFrame halfedge_frame(const Surface& surface, int halfedge) {
    const Point& a = surface.point(surface.origin(halfedge));
    const Point along = surface.point(surface.target(halfedge)) - a;
    const Point apex = surface.point(surface.origin(Surface::prev(halfedge))) - a;
    HalfedgeFrame frame;
    frame.length = along.norm();
    frame.inverse = frame.length > 0 ? 1 / frame.length : 0;
    frame.apex_x = along.dot(apex) * frame.inverse;
    frame.apex_y = along.cross(apex).norm() * frame.inverse;
    return frame;
}

SurfaceMetric::SurfaceMetric(const Surface& surface)
    : surface_(surface),
      known_(surface.face_count(), 0),
      angle_sum_(surface.vertex_count(), unknown),
      frame_(new HalfedgeFrame[surface.halfedge_count()]),
      corner_angle_(new double[surface.halfedge_count()]),
      fan_angle_(new double[surface.halfedge_count()]) {}

void SurfaceMetric::measure(int face) {
    for (int h = 3 * face; h < 3 * face + 3; ++h) {
        frame_[h] = halfedge_frame(surface_, h);
        corner_angle_[h] = std::atan2(frame_[h].apex_y, frame_[h].apex_x);
    }
    known_[face] = 1;
}

void SurfaceMetric::sweep(int vertex) {
    double sum = 0;
    const int first = surface_.outgoing(vertex);
    for (int h = first; h != none;) {
        fan_angle_[h] = sum;
        sum += corner_angle(h);
        h = surface_.twin(Surface::prev(h));
        if (h == first)
            break;
    }
    angle_sum_[vertex] = sum;
}

Eigen::Vector2d to_frame(const HalfedgeFrame& frame, int halfedge, const Eigen::Vector3d& bary) {
    const double b = bary[(halfedge + 1) % 3], c = bary[(halfedge + 2) % 3];
    return {b * frame.length + c * frame.apex_x, c * frame.apex_y};
}

SurfacePoint from_frame(const HalfedgeFrame& frame, int halfedge, const Eigen::Vector2d& at) {
    const double c = frame.apex_y > 0 ? std::clamp(at.y() / frame.apex_y, 0.0, 1.0) : 0.0;
    const double b = std::clamp((at.x() - c * frame.apex_x) * frame.inverse, 0.0, 1.0 - c);
    SurfacePoint point;
    point.face = halfedge / 3;
    point.bary[halfedge % 3] = std::max(0.0, 1 - b - c);
    point.bary[(halfedge + 1) % 3] = b;
    point.bary[(halfedge + 2) % 3] = c;
    return point;
}

Place place_of(const Surface& surface, const SurfacePoint& at) {
    constexpr double snap = 1e-12;
    Place place;
    int zeros = 0, zero = 0;
    for (int k = 0; k < 3; ++k)
        if (at.bary[k] < snap) {
            ++zeros;
            zero = k;
        }
    if (zeros >= 2) {
        int k = 0;
        at.bary.maxCoeff(&k);
        place.vertex = surface.face(at.face)[k];
    } else if (zeros == 1) {
        place.halfedge = 3 * at.face + (zero + 1) % 3;
    }
    return place;
}

void check_point(const Surface& surface, const SurfacePoint& at, const char* what) {
    if (at.face < 0 || at.face >= surface.face_count())
        throw Error(ErrorKind::bad_input, std::string(what) + ": face " + std::to_string(at.face) +
                                              " is not one of the surface's " + std::to_string(surface.face_count()));
    if (!at.bary.allFinite() || at.bary.minCoeff() < -1e-9 || std::abs(at.bary.sum() - 1) > 1e-9)
        throw Error(ErrorKind::bad_input, std::string(what) + " in face " + std::to_string(at.face) +
                                              ": barycentric coordinates must be >= 0 and sum to 1");
}

}  // namespace pvg
