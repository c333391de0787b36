#include "scene/compare.h"

#include <algorithm>

namespace pvg {
namespace {

bool same(const ScenePoint& a, const ScenePoint& b) {
    return a.on_face == b.on_face && a.position == b.position && a.face == b.face && a.bary == b.bary;
}

bool same(const ScenePath& a, const ScenePath& b) {
    const auto same_points = [](const ScenePoint& x, const ScenePoint& y) { return same(x, y); };
    return a.kind == b.kind && std::equal(a.points.begin(), a.points.end(), b.points.begin(), b.points.end(), same_points) &&
           a.closed == b.closed && a.degree == b.degree && a.parameter_curve == b.parameter_curve && a.snap_any == b.snap_any &&
           same(a.center, b.center) && a.radius == b.radius && a.start.has_value() == b.start.has_value() &&
           (!a.start || same(*a.start, *b.start));
}

bool same_quantities(const SideValues& a, const SideValues& b) {
    return a.color.empty() == b.color.empty() && a.height.empty() == b.height.empty();
}

bool same(const DiffusionCurve& a, const DiffusionCurve& b) {
    return same(a.path, b.path) && same_quantities(a.left, b.left) && same_quantities(a.right, b.right);
}

bool same(const PoissonCurve& a, const PoissonCurve& b) {
    if (!same(a.path, b.path) || a.width != b.width)
        return false;
    if (a.width > 0)  // each stop has a source profile of its own
        return a.color_jump.t == b.color_jump.t && a.height_jump.t == b.height_jump.t;
    return a.color_jump.empty() == b.color_jump.empty() && a.height_jump.empty() == b.height_jump.empty();
}

bool same(const PoissonRegion& a, const PoissonRegion& b) {
    return same(a.path, b.path) && a.by_rise == b.by_rise && a.color.has_value() == b.color.has_value() &&
           a.height.has_value() == b.height.has_value() && a.ring == b.ring;
}

bool same(const Primitive& a, const Primitive& b) {
    if (a.pointer != b.pointer || a.enabled != b.enabled || a.shape.index() != b.shape.index())
        return false;
    return std::visit([&](const auto& shape) { return same(shape, std::get<std::decay_t<decltype(shape)>>(b.shape)); }, a.shape);
}

bool same(const Layer& a, const Layer& b) {
    return a.on_displaced == b.on_displaced &&
           std::equal(a.primitives.begin(), a.primitives.end(), b.primitives.begin(), b.primitives.end(),
                      [](const Primitive& x, const Primitive& y) { return same(x, y); });
}

bool same_parameters(const Primitive& a, const Primitive& b) {
    if (const auto* x = std::get_if<DiffusionCurve>(&a.shape)) {
        const DiffusionCurve& y = std::get<DiffusionCurve>(b.shape);
        return x->left.color.t == y.left.color.t && x->left.height.t == y.left.height.t && x->right.color.t == y.right.color.t &&
               x->right.height.t == y.right.height.t;
    }
    if (const auto* x = std::get_if<PoissonCurve>(&a.shape)) {
        const PoissonCurve& y = std::get<PoissonCurve>(b.shape);
        return x->color_jump.t == y.color_jump.t && x->height_jump.t == y.height_jump.t;
    }
    return true;
}

}  // namespace

bool same_stops(const Scene& a, const Scene& b) {
    for (std::size_t l = 0; l < a.layers.size(); ++l)
        for (std::size_t p = 0; p < a.layers[l].primitives.size(); ++p)
            if (!same_parameters(a.layers[l].primitives[p], b.layers[l].primitives[p]))
                return false;
    return true;
}

bool same_geometry(const Scene& a, const Scene& b) {
    return a.mesh_file == b.mesh_file && a.mesh_select == b.mesh_select && a.max_edge == b.max_edge &&
           a.subdivide == b.subdivide && a.unit_is_bbox == b.unit_is_bbox && a.knot_spacing == b.knot_spacing &&
           a.knot_grading == b.knot_grading && a.basis == b.basis && a.basis_rings == b.basis_rings &&
           a.basis_normalize == b.basis_normalize &&
           std::equal(a.layers.begin(), a.layers.end(), b.layers.begin(), b.layers.end(),
                      [](const Layer& x, const Layer& y) { return same(x, y); });
}

}  // namespace pvg
