// The whole pipeline in memory: a procedural mesh and a scene as JSON, evaluated by the CPU reference.
#pragma once

#include <stdexcept>
#include <string>

#include <nlohmann/json.hpp>

#include "cpu_reference/cpu_evaluator.h"
#include "mesh/shapes.h"
#include "scene/scene.h"
#include "solve/build.h"

namespace pvg::test {

using nlohmann::json;

struct Decorated {
    Scene scene;
    Build build;
    Evaluation evaluation;
    Warnings warnings;

    int vertex_count() const { return build.arrangement.output.vertex_count(); }
    const Point& base(int v) const { return build.arrangement.output.point(v); }
    /// Channel of a layer's field at an output vertex; reached() first.
    bool reached(int domain, int v) const { return domain != none && build.arrangement.domain_vertex[domain][v] != none; }
    double value(int domain, int channel, int v) const {
        const int vertex = build.arrangement.domain_vertex[domain][v];
        const Table& table = build.program.fields[domain].table;
        return evaluation.values[domain][static_cast<std::size_t>(table.vertex_row[vertex]) * table.channels + channel];
    }
    const LayerFields& layer(int l = 0) const { return build.arrangement.layers.at(l); }
    double height(int v, int l = 0) const { return value(layer(l).height_domain, layer(l).height_channel, v); }
    /// A third of the areas around an output vertex.
    std::vector<double> vertex_areas() const {
        std::vector<double> areas(vertex_count(), 0);
        const Surface& s = build.arrangement.output;
        for (int h = 0; h < s.halfedge_count(); ++h) areas[s.origin(h)] += s.face_area(h / 3) / 3;
        return areas;
    }
};

inline Decorated decorate(const json& primitives, const ShapeMesh& mesh, const json& extra = json::object(), int threads = 0) {
    json document = {{"pvg", 1},
                     {"mesh", {{"file", "mesh.glb"}}},
                     {"length_unit", "mesh"},
                     {"layers", json::array({{{"name", "test"}, {"primitives", primitives}}})}};
    document.update(extra);
    Decorated result;
    result.scene = parse_scene(document, "test.pvg.json");
    BuildOptions options;
    options.threads = threads;
    result.build = build(result.scene, {mesh.points, mesh.normals, mesh.faces}, options, result.warnings);
    result.evaluation = evaluate_on_cpu(result.build.program, threads);
    return result;
}

/// Area-weighted mean and largest error against a function of position, % of `range`, over the vertices where it is defined.
struct Errors {
    double mean = 0, max = 0;
    int vertices = 0;
};

template <typename Truth>
Errors height_errors(const Decorated& d, double range, Truth truth) {
    const std::vector<double> areas = d.vertex_areas();
    Errors errors;
    double weight = 0;
    for (int v = 0; v < d.vertex_count(); ++v) {
        if (!d.reached(d.layer().height_domain, v))
            continue;
        const double error = std::abs(d.height(v) - truth(d.base(v), v)) / range * 100;
        if (std::isnan(error))
            continue;
        errors.mean += areas[v] * error;
        errors.max = std::max(errors.max, error);
        weight += areas[v];
        ++errors.vertices;
    }
    if (weight > 0)
        errors.mean /= weight;
    return errors;
}

}  // namespace pvg::test
