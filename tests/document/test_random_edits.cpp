// Long sessions of random edits, evaluated on the device with the validation layers on: nothing leaks, nothing grows, and what is
// left is the state of the scene that is left. PVG_EDITS sets how many (200 unless told; 10,000 under the sanitizers takes
// minutes).
#include <malloc.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "cpu_reference/cpu_evaluator.h"
#include "mesh/shapes.h"
#include "pvg/scene_document.h"
#include "pvg/vulkan.h"

namespace pvg {
namespace {

using nlohmann::json;

MeshData torus() {
    const ShapeMesh shape = make_shape("torus", 700);
    MeshData mesh;
    for (const Point& p : shape.points) mesh.points.push_back({float(p[0]), float(p[1]), float(p[2])});
    for (const Face& f : shape.faces) mesh.faces.push_back({std::uint32_t(f[0]), std::uint32_t(f[1]), std::uint32_t(f[2])});
    return mesh;
}

json circle_curve(const std::string& id, double angle, double radius) {
    const json path = {{"type", "circle"},
                       {"center", {0.75 * std::cos(angle), 0.75 * std::sin(angle), 0.3}},
                       {"radius", radius},
                       {"snap", "any"}};
    return {{"kind", "diffusion_curve"},
            {"id", id},
            {"path", path},
            {"left", {{{"t", 0}, {"color", {1, 0, 0}}, {"height", 0.02}}, {{"t", 0.5}, {"color", {1, 1, 0}}, {"height", 0.03}}}},
            {"right", {{"color", {0, 0, 1}}, {"height", 0}}}};
}

json scene() {
    json bump = circle_curve("bump", 3.5, 0.1);
    bump["kind"] = "poisson_region";
    bump.erase("left");
    bump.erase("right");
    bump["rise"] = {{"color", {0.1, 0.2, 0}}, {"height", 0.02}};
    return {{"pvg", 1},
            {"mesh", {{"file", "in_memory.glb"}}},
            {"length_unit", "mesh"},
            {"knots", {{"spacing", 0.2}}},
            {"layers", {{{"name", "a"}, {"primitives", {circle_curve("c0", 0, 0.15), circle_curve("c1", 1.5, 0.2), bump}}}}}};
}

class Session {
public:
    explicit Session(unsigned seed) : random_(seed), document_(open()) {}

    Result<Change> step() {
        const char* curves[] = {"c0", "c1"};
        const char* curve = curves[random_() % 2];
        const Part side = random_() % 2 ? Part::left : Part::right;
        const std::size_t stop = side == Part::left ? random_() % 2 : 0;
        switch (random_() % 40) {
            case 0:
                return document_.move_point(curve, 0, {0.7 + 0.1 * real(), 0.4 * real(), 0.3});
            case 1:
                return document_.enable("bump", random_() % 2 == 0);
            case 2:
                return document_.set("c1.path.radius=" + std::to_string(0.1 + 0.1 * real()));
            case 3:
                return document_.set_stops(
                    curve, Part::left,
                    {{0, {{real(), real(), real(), 1}}, 0.05 * real()}, {0.2 + 0.6 * real(), {{1, 1, 1, 1}}, 0.0}});
            case 4: {
                const Result<Change> added = document_.add(0, circle_curve("extra", 4.5 + real(), 0.08).dump());
                return added ? document_.remove("extra") : added;
            }
            case 5:
            case 6:
            case 7:
                return document_.can_undo() ? document_.undo() : document_.set_height("c0", Part::right, 0, real());
            case 8:
            case 9:
                return document_.can_redo() ? document_.redo() : document_.set_height("c1", Part::right, 0, real());
            case 10:
                return document_.set_laplacian("bump", {{{real(), real(), real()}}}, 0.1 * real());
            case 11:
                return document_.set_color("nobody", side, stop, {1, 1, 1, 1});  // refused
            case 12:
                return document_.set_height(curve, side, stop, NAN);  // refused
            default:
                return random_() % 2 ? document_.set_color(curve, side, stop, {real(), real(), real(), real()})
                                     : document_.set_height(curve, side, stop, 0.1 * real());
        }
    }
    SceneDocument& document() { return document_; }

private:
    double real() { return std::uniform_real_distribution<double>(0, 1)(random_); }
    static SceneDocument open() {
        Result<SceneDocument> made = SceneDocument::create(scene().dump(), torus(), "scene", {.undo_limit = 20});
        if (!made)
            throw Error(made.error());
        return std::move(made.value());
    }

    std::mt19937 random_;
    SceneDocument document_;
};

TEST(RandomEdits, OnTheDeviceWithValidation) {
    const char* wanted = std::getenv("PVG_EDITS");
    const int edits = wanted ? std::atoi(wanted) : 200;
    Result<VulkanEvaluator> evaluator = VulkanEvaluator::create({.device = {}, .validation = true});
    Session session(1);
    SceneDocument& document = session.document();
    if (evaluator) {
        ASSERT_TRUE(evaluator.value().load(document.program()));
    }
    int rebuilt = 0, refused = 0;
    std::size_t settled = 0, most = 0;  // bytes in use when the session has seen everything, and the most after that
    for (int k = 0; k < edits; ++k) {
        const Result<Change> change = session.step();
        if (!change) {
            ++refused;
            continue;
        }
        if (evaluator) {
            VulkanEvaluator& gpu = evaluator.value();
            if (change.value().rebuilt) {
                ASSERT_TRUE(gpu.load(document.program()));
            } else {
                for (std::uint32_t f : change.value().fields)
                    ASSERT_TRUE(gpu.set_coefficients(f, document.program().fields[f].coefficients));
            }
            if (change.value().rebuilt || k % 10 == 0) {
                const Result<Evaluation> seen = gpu.evaluate();
                ASSERT_TRUE(seen) << seen.error().what();
                EXPECT_EQ(seen.value().values, evaluate_on_cpu(document.program()).values);
            }
        }
        rebuilt += change.value().rebuilt;
        if (k % 50 == 49) {
            const std::size_t used = mallinfo2().uordblks;
            if (k + 1 <= edits / 2)
                settled = std::max(settled, used);
            else
                most = std::max(most, used);
        }
    }
    std::printf("%d edits, %d rebuilt, %d refused, %.1f MiB in use at most in the first half, %.1f in the second\n", edits,
                rebuilt, refused, static_cast<double>(settled) / (1 << 20), static_cast<double>(most) / (1 << 20));
    EXPECT_GT(rebuilt, 0);
    EXPECT_GT(refused, 0);
    if (settled > 0) {  // the sanitizer's allocator does not count
        EXPECT_LE(static_cast<double>(most), 1.25 * static_cast<double>(settled));
    }

    const Result<SceneDocument> fresh = SceneDocument::create(document.scene(), torus());
    ASSERT_TRUE(fresh);
    const Evaluation a = evaluate_on_cpu(document.program()), b = evaluate_on_cpu(fresh.value().program());
    ASSERT_EQ(a.values.size(), b.values.size());
    for (std::size_t f = 0; f < a.values.size(); ++f) {
        ASSERT_EQ(a.values[f].size(), b.values[f].size());
        for (std::size_t i = 0; i < a.values[f].size(); ++i) EXPECT_NEAR(a.values[f][i], b.values[f][i], 3e-5);
    }
    if (!evaluator)
        GTEST_SKIP() << "evaluated on the CPU alone: " << evaluator.error().what();
}

}  // namespace
}  // namespace pvg
