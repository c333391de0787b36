// Scenes as JSON on procedural surfaces, arranged from beginning to end.
#pragma once

#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "edge_drawing.h"
#include "scene/scene.h"

namespace pvg::test {

using nlohmann::json;

inline BaseSurface base_of(const Surface& surface) {
    BaseSurface base{surface, identity_map(surface), surface, {}, {}};
    for (int f = 0; f < surface.face_count(); ++f) base.face_raw.push_back(f);
    return base;
}

struct Arranged {
    Scene scene;
    BaseSurface base;
    Warnings warnings;
    Arrangement result;
};

/// Lengths in mesh units. primitives: of one layer.
inline Scene scene_of(const json& primitives, const json& extra = json::object()) {
    json document = {{"pvg", 1},
                     {"mesh", {{"file", "mesh.glb"}}},
                     {"length_unit", "mesh"},
                     {"layers", json::array({{{"name", "test"}, {"primitives", primitives}}})}};
    document.update(extra);
    return parse_scene(document, "test.pvg.json");
}

inline Arranged arranged(const Surface& surface, const json& primitives, const json& extra = json::object()) {
    Arranged a{scene_of(primitives, extra), base_of(surface), {}, {}};
    a.result = arrange(a.scene, a.base, a.warnings);
    return a;
}

inline json circle(double x, double y, double z, double radius) {
    return {{"type", "circle"}, {"center", {x, y, z}}, {"radius", radius}};
}
inline json circle(double x, double y, double radius) { return circle(x, y, 0, radius); }
inline json polyline(const json& points, bool closed = false) {
    return {{"type", "polyline"}, {"points", points}, {"closed", closed}};
}
inline json height_curve(const json& path, const json& left, const json& right) {
    json curve = {{"kind", "diffusion_curve"}, {"path", path}};
    if (!left.is_null())
        curve["left"] = {{"height", left}};
    if (!right.is_null())
        curve["right"] = {{"height", right}};
    return curve;
}
inline json rim(double size) { return polyline({{0, 0, 0}, {size, 0, 0}, {size, size, 0}, {0, size, 0}}, true); }

/// Integral of a column's profile and of its absolute value.
inline std::pair<double, double> integral(const Domain& domain, const SourceColumn& column) {
    double sum = 0, size = 0;
    for (const auto& [f, value] : column.profile) {
        sum += value * domain.surface.face_area(f);
        size += std::abs(value) * domain.surface.face_area(f);
    }
    return {sum, size};
}

}  // namespace pvg::test
