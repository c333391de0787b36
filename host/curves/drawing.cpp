#include "curves/drawing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "curves/curve_path.h"
#include "curves/joints.h"
#include "curves/offset.h"
#include "curves/region.h"
#include "curves/ring.h"
#include "curves/scene_points.h"
#include "curves/strip.h"
#include "pvg/status.h"

namespace pvg {
namespace {

/// Runs work; an error of it gets the place in the scene in front.
template <typename Work>
auto at_place(const std::string& where, Work&& work) {
    try {
        return work();
    } catch (const Error& error) {
        throw Error(error.kind(), where + ": " + error.what());
    }
}

const ScenePath& path_of(const Primitive& primitive) {
    return std::visit([](const auto& shape) -> const ScenePath& { return shape.path; }, primitive.shape);
}

/// All parameters at which the primitive's values have stops.
std::vector<double> stops_of(const Primitive& primitive) {
    std::vector<double> all;
    const auto add = [&](const std::vector<double>& t) { all.insert(all.end(), t.begin(), t.end()); };
    if (const auto* dc = std::get_if<DiffusionCurve>(&primitive.shape)) {
        for (const SideValues* side : {&dc->left, &dc->right}) {
            add(side->color.t);
            add(side->height.t);
        }
    } else if (const auto* pc = std::get_if<PoissonCurve>(&primitive.shape)) {
        add(pc->color_jump.t);
        add(pc->height_jump.t);
    }
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
}

double mean_edge(const Surface& surface, int face) {
    return (surface.length(3 * face) + surface.length(3 * face + 1) + surface.length(3 * face + 2)) / 3;
}

/// A point of the path at a parameter between those of its points, so that the chain has a vertex there.
void insert_parameter(const Surface& surface, SampledCurve& curve, double t) {
    constexpr double same = 1e-6;
    const auto next = std::upper_bound(curve.t.begin(), curve.t.end(), t);
    const std::size_t j = static_cast<std::size_t>(next - curve.t.begin());
    if (j == 0 || (j == curve.t.size() && !curve.path.closed))
        return;
    const double before = curve.t[j - 1], after = j == curve.t.size() ? 1.0 : curve.t[j];
    if (t - before < same || after - t < same)
        return;
    const SurfacePoint& a = curve.path.points[j - 1];
    const SurfacePoint& b = curve.path.points[j % curve.path.points.size()];
    const int face = common_face(surface, a, b);
    if (face == none)
        return;
    const double s = (t - before) / (after - before);
    SurfacePoint middle{face, (1 - s) * bary_in(surface, face, a) + s * bary_in(surface, face, b)};
    curve.path.points.insert(curve.path.points.begin() + static_cast<std::ptrdiff_t>(j), middle);
    curve.t.insert(curve.t.begin() + static_cast<std::ptrdiff_t>(j), t);
}

/// Towards +x; where the surface faces that way, or another part of it lies there, towards the next of the six axes that leads
/// away from the center on its own part. Where none does, a corner of the center's face.
SurfacePoint default_start(const Surface& surface, const ScenePoints& points, const SurfacePoint& center, double radius) {
    const Point middle = surface.position(center);
    const std::vector<int> part = face_components(surface);
    for (const double sign : {1.0, -1.0})
        for (const Point& axis : {Point(Point::UnitX()), Point(Point::UnitY()), Point(Point::UnitZ())}) {
            const SurfacePoint start = points.closest(middle + sign * radius * axis);
            if (part[start.face] == part[center.face] && (surface.position(start) - middle).norm() >= 0.1 * radius)
                return start;
        }
    int farthest = 0;
    const auto distance = [&](int k) { return (surface.point(surface.face(center.face)[k]) - middle).norm(); };
    for (int k : {1, 2})
        if (distance(k) > distance(farthest))
            farthest = k;
    SurfacePoint start{center.face, Eigen::Vector3d::Zero()};
    start.bary[farthest] = 1;
    return start;
}

SampledCurve trace(const ScenePath& path, const ScenePoints& points, const BaseSurface& base, double unit,
                   const std::string& where) {
    const Surface& surface = base.surface;
    CurveOptions options;
    options.closed = path.closed;
    options.parameter_curve = path.parameter_curve;
    if (path.kind == PathKind::circle) {
        const SurfacePoint center = points.resolve(path.center, path.snap_any);
        const double radius = path.radius * unit;
        SurfacePoint start;
        if (path.start) {
            start = points.resolve(*path.start, path.snap_any);
        } else {
            start = default_start(surface, points, center, radius);
        }
        const double tolerance = std::min(1e-3 * radius, 0.02 * mean_edge(surface, center.face));
        options.tolerance = tolerance;
        return at_place(where, [&] {
            SampledCurve curve = circle_curve(surface, center, radius, start, options);
            std::vector<std::size_t> kept;
            curve.path = simplified(surface, curve.path, tolerance, &kept);
            for (std::size_t i = 0; i < kept.size(); ++i) curve.t[i] = curve.t[kept[i]];
            curve.t.resize(kept.size());
            return curve;
        });
    }
    std::vector<SurfacePoint> control;
    for (const ScenePoint& point : path.points) control.push_back(points.resolve(point, path.snap_any));
    return at_place(where, [&] {
        switch (path.kind) {
            case PathKind::bspline:
                return bspline_curve(surface, control, path.degree, options);
            case PathKind::bezier:
                return bezier_curve(surface, control, path.degree, options);
            default:
                return polyline_curve(surface, control, options);
        }
    });
}

/// A region's border may not lie on an edge where the surface had to be cut because more than two faces meet.
void refuse_non_manifold(const BaseSurface& base, const Surface& imprinted, const CurveChain& chain) {
    if (base.non_manifold_edges.empty())
        return;
    const double near = 1e-9 * base.welded.diagonal();
    for (int v : chain.vertices) {
        if (!imprinted.is_border_vertex(v))
            continue;
        const Point& p = imprinted.point(v);
        for (const auto& [a, b] : base.non_manifold_edges) {
            const double s = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
            if ((p - a - s * (b - a)).norm() > near)
                continue;
            char text[160];
            std::snprintf(text, sizeof text,
                          "the path meets an edge where more than two faces meet, at [%.6g, %.6g, %.6g]; expected a path on one "
                          "sheet of the surface",
                          p[0], p[1], p[2]);
            throw Error(ErrorKind::bad_input, text);
        }
    }
}

bool is_wide(const Primitive& primitive) {
    const auto* curve = std::get_if<PoissonCurve>(&primitive.shape);
    return curve && curve->width > 0;
}

/// Whether the surface is slit along it, so that values could leak past its ends.
bool may_slit(const Primitive& primitive) {
    return std::holds_alternative<DiffusionCurve>(primitive.shape) ||
           (std::holds_alternative<PoissonCurve>(primitive.shape) && !is_wide(primitive));
}

/// Imprints a curve at a distance from another one, given on the drawn surface. Loops too small to bound anything are left out.
void imprint_offset(Imprinter& imprinter, const Surface& base, const RefinedSurface& drawn, const SurfacePath& path,
                    double distance, std::vector<int>& chains) {
    const SurfacePath on_base = simplified(base, to_parent(base, drawn, path), 0.005 * distance);
    if (length(base, on_base) < 0.1 * distance || on_base.points.size() < 3)
        return;
    std::vector<double> t(on_base.points.size());
    for (std::size_t i = 0; i < t.size(); ++i) t[i] = static_cast<double>(i) / static_cast<double>(t.size());
    chains.push_back(imprinter.imprint(on_base, t));
}

std::vector<DrawnSource> sources_of(const Primitive& primitive, const Surface& imprinted, const CurveChain& chain,
                                    const std::vector<CurveChain>& borders, double unit) {
    std::vector<DrawnSource> sources;
    if (const auto* region = std::get_if<PoissonRegion>(&primitive.shape)) {
        double peak = 0;
        DrawnSource source{region_profile(imprinted, chain, borders, region->by_rise ? &peak : nullptr), {}, 0};
        // A rise is measured by the peak of the region's own problem (f < 0 raises); a Laplacian is per length unit^2.
        if (region->by_rise && !(peak > 0))
            throw Error(ErrorKind::bad_input,
                        "the region has no vertex inside that could rise; expected a larger region or a finer mesh");
        const double scale = region->by_rise ? -1 / peak : 1 / (unit * unit);
        for (auto& [face, laplacian] : source.profile) laplacian *= scale;
        sources.push_back(std::move(source));
    } else if (is_wide(primitive)) {
        const auto& curve = std::get<PoissonCurve>(primitive.shape);
        std::vector<std::vector<double>> lists;
        for (const std::vector<double>* t : {&curve.color_jump.t, &curve.height_jump.t})
            if (!t->empty() && std::find(lists.begin(), lists.end(), *t) == lists.end())
                lists.push_back(*t);
        for (const std::vector<double>& stops : lists) {
            auto profiles = strip_profiles(imprinted, chain, borders, curve.width * unit, stops);
            for (std::size_t k = 0; k < profiles.size(); ++k) sources.push_back({std::move(profiles[k]), stops, k});
        }
    }
    return sources;
}

}  // namespace

Drawing draw(const Scene& scene, const BaseSurface& base, double unit) {
    Drawing drawing;
    const ScenePoints points(scene, base);
    Imprinter imprinter(base.surface);
    std::vector<int> chains;
    for (std::size_t l = 0; l < scene.layers.size(); ++l) {
        Joints joints(base.surface);
        for (const Primitive& primitive : scene.layers[l].primitives) {
            if (!primitive.enabled)
                continue;
            DrawnPrimitive drawn;
            drawn.primitive = &primitive;
            drawn.layer = static_cast<int>(l);
            drawn.where = scene.file.string() + ": " + primitive.pointer;
            const ScenePath& path = path_of(primitive);
            const std::string path_place = scene.file.string() + ": " + (path.pointer.empty() ? primitive.pointer : path.pointer);
            SampledCurve curve = trace(path, points, base, unit, path_place);
            std::array<bool, 2> met{false, false};
            if (may_slit(primitive))
                met = at_place(path_place, [&] { return joints.join(curve); });
            // A vertex at every stop; and a curve of one edge could not be slit.
            std::vector<double> stops = stops_of(primitive);
            if (!path.closed && curve.path.points.size() < 3)
                stops.push_back(0.5);
            for (double t : stops) insert_parameter(base.surface, curve, t);
            chains.push_back(at_place(path_place, [&] { return imprinter.imprint(curve.path, curve.t); }));
            if (may_slit(primitive))
                joints.add(imprinter, imprinter.chain(chains.back()), met);
            drawing.primitives.push_back(std::move(drawn));
        }
    }

    // Rings and strips are measured on the surface with all curves on it, then imprinted too.
    std::vector<std::vector<int>> border_chains(chains.size());
    {
        const RefinedSurface drawn = imprinter.surface();
        std::vector<std::pair<std::size_t, std::pair<SurfacePath, double>>> offsets;
        for (std::size_t p = 0; p < chains.size(); ++p) {
            const Primitive& primitive = *drawing.primitives[p].primitive;
            const CurveChain chain = without_spikes(imprinter.chain(chains[p]));
            at_place(drawing.primitives[p].where, [&] {
                if (const auto* region = std::get_if<PoissonRegion>(&primitive.shape)) {
                    refuse_non_manifold(base, drawn.surface, chain);
                    double width = 0;
                    if (region->ring)
                        for (SurfacePath& path : ring_borders(drawn.surface, chain, *region->ring, &width))
                            offsets.push_back({p, {std::move(path), width}});
                } else if (is_wide(primitive)) {
                    const double width = std::get<PoissonCurve>(primitive.shape).width * unit;
                    for (SurfacePath& path : strip_borders(drawn.surface, chain, width))
                        offsets.push_back({p, {std::move(path), width}});
                }
            });
        }
        for (const auto& [p, offset] : offsets)
            at_place(drawing.primitives[p].where,
                     [&] { imprint_offset(imprinter, base.surface, drawn, offset.first, offset.second, border_chains[p]); });
    }

    drawing.imprinted = imprinter.surface();
    for (std::size_t p = 0; p < chains.size(); ++p) {
        DrawnPrimitive& drawn = drawing.primitives[p];
        drawn.chain = without_spikes(imprinter.chain(chains[p]));
        for (int border : border_chains[p]) drawn.borders.push_back(without_spikes(imprinter.chain(border)));
        at_place(drawn.where, [&] {
            drawn.sources = sources_of(*drawn.primitive, drawing.imprinted.surface, drawn.chain, drawn.borders, unit);
        });
    }
    return drawing;
}

}  // namespace pvg
