// Decorates a sphere through the installed library and checks the result.
#include <cmath>
#include <cstdio>

#include "cpu_reference/cpu_evaluator.h"
#include "mesh/shapes.h"
#include "scene/scene.h"
#include "solve/build.h"

int main() {
    const pvg::ShapeMesh sphere = pvg::make_shape("sphere", 1000);
    const auto document =
        nlohmann::json::parse(R"({"pvg": 1, "mesh": {"file": "sphere.glb"}, "layers": [{"name": "a", "primitives": [
        {"kind": "diffusion_curve", "path": {"type": "circle", "center": [0, 0, 0.5], "radius": 0.2, "snap": "any"}, "left": {"height": 0.1}}]}]})");
    try {
        pvg::Warnings warnings;
        const pvg::Scene scene = pvg::parse_scene(document, "consumer.pvg.json");
        const pvg::Build build = pvg::build(scene, {sphere.points, sphere.normals, sphere.faces}, {}, warnings);
        const pvg::Evaluation result = pvg::evaluate_on_cpu(build.program);
        int raised = 0;
        for (float height : result.height) raised += std::abs(height - 0.1f) < 1e-5f ? 1 : 0;
        std::printf("%d vertices raised\n", raised);
        return raised > 50 ? 0 : 1;
    } catch (const pvg::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
