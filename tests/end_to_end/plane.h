// The flat sheet that most whole-pipeline tests draw on.
#pragma once

#include <array>
#include <vector>

#include "end_to_end/pipeline.h"

namespace pvg::test {

/// A unit-square plane, its middle and its length unit (the diagonal).
struct Plane {
    ShapeMesh mesh;
    Point middle;
    double diagonal;

    explicit Plane(int vertices) : mesh(make_shape("plane", vertices)) {
        Point low = mesh.points.at(0), high = low;
        for (const Point& p : mesh.points) {
            low = low.cwiseMin(p);
            high = high.cwiseMax(p);
        }
        middle = (low + high) / 2;
        diagonal = (high - low).norm();
    }
    json at(double x, double y) const { return {middle[0] + x, middle[1] + y, middle[2]}; }
    json circle(double x, double y, double radius) const {
        return {{"type", "circle"}, {"center", at(x, y)}, {"radius", radius / diagonal}};
    }
    json polyline(const std::vector<std::array<double, 2>>& points, bool closed) const {
        json list = json::array();
        for (const auto& [x, y] : points) list.push_back(at(x, y));
        return {{"type", "polyline"}, {"points", list}, {"closed", closed}};
    }
    /// Height `value` on the inside of a circle; the outside stays open.
    json rim(double radius, const json& value) const {
        return {{"kind", "diffusion_curve"}, {"path", circle(0, 0, radius)}, {"left", value}};
    }
};

}  // namespace pvg::test
