// Editing: every state that edits lead to is the state of the scene they leave, as a fresh document of that scene has it.
#include "pvg/scene_document.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "cpu_reference/cpu_evaluator.h"
#include "mesh/shapes.h"

namespace pvg {
namespace {

using nlohmann::json;

MeshData sphere(int vertices) {
    const ShapeMesh shape = make_shape("sphere", vertices);
    MeshData mesh;
    for (const Point& p : shape.points) mesh.points.push_back({float(p[0]), float(p[1]), float(p[2])});
    for (const Point& p : shape.normals) mesh.normals.push_back({float(p[0]), float(p[1]), float(p[2])});
    for (const Face& f : shape.faces) mesh.faces.push_back({std::uint32_t(f[0]), std::uint32_t(f[1]), std::uint32_t(f[2])});
    return mesh;
}

json circle(double x, double y, double z, double radius) {
    return {{"type", "circle"}, {"center", {x, y, z}}, {"radius", radius}, {"snap", "any"}};
}

/// A two-sided circle of colour and height with stops, a height circle, a region between and a sharp and a wide jump.
json scene() {
    const json rim = {
        {"kind", "diffusion_curve"},
        {"id", "rim"},
        {"path", circle(0, 0, 1, 0.6)},
        {"left", {{"color", {1, 0, 0}}, {"height", 0.05}}},
        {"right", {{{"t", 0}, {"color", {0, 0, 1}}, {"height", 0}}, {{"t", 0.5}, {"color", {0, 1, 0}}, {"height", 0.02}}}}};
    const json base = {{"kind", "diffusion_curve"},
                       {"id", "base"},
                       {"path", circle(0, 0, -1, 0.5)},
                       {"left", {{"color", {1, 1, 0, 0.5}}, {"height", 0}}},
                       {"right", {{"color", {1, 1, 1}}, {"height", -0.02}}}};
    const json bump = {{"kind", "poisson_region"},
                       {"id", "bump"},
                       {"path", circle(1, 0, 0, 0.3)},
                       {"rise", {{"color", {0.2, 0, 0}}, {"height", 0.05}}}};
    const json crack = {{"kind", "poisson_curve"},
                        {"id", "crack"},
                        {"path", circle(-1, 0, 0, 0.3)},
                        {"jump", {{"color", {0, 0.1, 0}}, {"height", 0.03}}}};
    return {{"pvg", 1},
            {"mesh", {{"file", "in_memory.glb"}}},
            {"length_unit", "mesh"},
            {"knots", {{"spacing", 0.15}}},
            {"layers", {{{"name", "first"}, {"primitives", {rim, base, bump, crack}}}}}};
}

SceneDocument document(const json& content = scene(), const DocumentOptions& options = {}) {
    static const MeshData mesh = sphere(1500);
    Result<SceneDocument> made = SceneDocument::create(content.dump(), mesh, "scene", options);
    if (!made)
        throw Error(made.error());
    return std::move(made.value());
}

/// Geometry bit for bit, coefficients to the solver's tolerance.
void expect_same_state(const SceneDocument& edited, const SceneDocument& fresh, const std::string& what) {
    EXPECT_EQ(json::parse(edited.scene()), json::parse(fresh.scene())) << what;
    const Program &a = edited.program(), &b = fresh.program();
    ASSERT_EQ(a.fields.size(), b.fields.size()) << what;
    EXPECT_EQ(a.base, b.base) << what;
    EXPECT_EQ(edited.output().faces, fresh.output().faces) << what;
    EXPECT_EQ(edited.output().color_space, fresh.output().color_space) << what;
    for (std::size_t f = 0; f < a.fields.size(); ++f) {
        EXPECT_EQ(a.fields[f].table.indices, b.fields[f].table.indices) << what;
        EXPECT_EQ(a.fields[f].table.weights, b.fields[f].table.weights) << what;
    }
    const Evaluation u = evaluate_on_cpu(a), v = evaluate_on_cpu(b);
    for (std::size_t f = 0; f < u.values.size(); ++f) {
        double range = 0, most = 0;
        for (float x : v.values[f]) range = std::max(range, double{std::abs(x)});
        for (std::size_t i = 0; i < u.values[f].size(); ++i)
            most = std::max(most, std::abs(double{u.values[f][i]} - v.values[f][i]));
        EXPECT_LT(most, 2e-5 * range) << what << ", field " << f;
    }
}

TEST(SceneDocument, EveryKindOfValueWithoutABuild) {
    const std::vector<std::pair<std::string, std::function<Result<Change>(SceneDocument&)>>> edits = {
        {"color",
         [](SceneDocument& d) {
             return d.set_color("rim", Part::left, 0, {0.2, 0.4, 0.6, 1});
         }},
        {"color of a stop",
         [](SceneDocument& d) {
             return d.set_color("rim", Part::right, 1, {0.9, 0.1, 0.3, 0.7});
         }},
        {"height", [](SceneDocument& d) { return d.set_height("base", Part::right, 0, 0.1); }},
        {"by pointer", [](SceneDocument& d) { return d.set_height("/layers/0/primitives/1", Part::left, 0, 0.07); }},
        {"jump", [](SceneDocument& d) { return d.set_height("crack", Part::jump, 0, -0.05); }},
        {"region",
         [](SceneDocument& d) {
             return d.set_laplacian("bump", {{{0, 0.3, 0.1}}}, {});
         }},
        {"region's height", [](SceneDocument& d) { return d.set_laplacian("bump", {}, -0.1); }},
        {"stops",
         [](SceneDocument& d) {
             return d.set_stops("rim", Part::right, {{0, {{0, 0.5, 1, 1}}, 0.01}, {0.5, {{1, 0.5, 0, 1}}, 0.03}});
         }},
        {"space", [](SceneDocument& d) { return d.set("rim.left.color=\"#336699\""); }},
    };
    SceneDocument together = document();
    for (const auto& [what, edit] : edits) {
        SceneDocument alone = document();
        for (SceneDocument* d : {&alone, &together}) {
            const Result<Change> change = edit(*d);
            ASSERT_TRUE(change) << what << ": " << change.error().what();
            EXPECT_FALSE(change.value().rebuilt) << what;
            EXPECT_EQ(change.value().fields.size(), 1u) << what;
        }
        expect_same_state(alone, document(json::parse(alone.scene())), what);
    }
    expect_same_state(together, document(json::parse(together.scene())), "together");
}

TEST(SceneDocument, ShapesBuildAnew) {
    SceneDocument d = document();
    const auto expect_rebuilt = [&](const Result<Change>& change, const std::string& what) {
        ASSERT_TRUE(change) << what << ": " << change.error().what();
        EXPECT_TRUE(change.value().rebuilt) << what;
        expect_same_state(d, document(json::parse(d.scene())), what);
    };
    expect_rebuilt(d.move_point("bump", 0, {0.9, 0.3, 0.1}), "move");
    expect_rebuilt(d.enable("crack", false), "disable");
    expect_rebuilt(d.add(0, R"({"kind": "diffusion_curve", "id": "new", "path": {"type": "polyline", "snap": "any",
        "points": [[0, 1, 0.2], [0.3, 1, 0], [0, 1, -0.2]]}, "left": {"color": [0, 0, 0], "height": 0},
        "right": {"color": [1, 1, 1], "height": 0.01}})",
                         1),
                   "add");
    expect_rebuilt(d.move_point("new", 2, {0.1, 1, -0.3}), "move a control point");
    expect_rebuilt(d.set_stops("new", Part::left, {}), "a side opened");
    expect_rebuilt(d.remove("new"), "remove");
    expect_rebuilt(d.enable("crack", true), "enable");
    expect_rebuilt(d.set("rim.path.radius=0.5"), "radius");
    expect_rebuilt(d.set_stops("rim", Part::right, {{0.1, {{0, 0, 1, 1}}, 0.0}, {0.2, {{1, 0, 1, 1}}, 0.1}}), "stops");
}

TEST(SceneDocument, RandomEditsAndTheirUndoing) {
    for (unsigned seed = 1; seed <= 2; ++seed) {
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> in(0, 1);
        SceneDocument d = document();
        std::vector<json> scenes{json::parse(d.scene())};
        std::vector<std::vector<Field>> fields;
        for (int step = 0; step < 14; ++step) {
            const auto edit = [&]() -> Result<Change> {
                switch (random() % 8) {
                    case 0:
                        return d.move_point("bump", 0, {1, 0.3 * in(random), 0.3 * in(random)});
                    case 1:
                        return d.enable("crack", random() % 2 == 0);
                    case 2:
                        return d.set_height("rim", Part::right, random() % 2, 0.1 * in(random));
                    case 3:
                        return d.set_laplacian("bump", {{{in(random), in(random), in(random)}}}, 0.1 * in(random));
                    default:
                        return d.set_color(random() % 2 ? "rim" : "base", Part::left, 0,
                                           {in(random), in(random), in(random), in(random)});
                }
            };
            const Result<Change> change = edit();
            ASSERT_TRUE(change) << change.error().what();
            if (json::parse(d.scene()) != scenes.back())
                scenes.push_back(json::parse(d.scene()));
        }
        expect_same_state(d, document(scenes.back()), "forward");
        for (std::size_t i = scenes.size(); i-- > 1;) {
            ASSERT_TRUE(d.can_undo());
            ASSERT_TRUE(d.undo());
            EXPECT_EQ(json::parse(d.scene()), scenes[i - 1]);
        }
        EXPECT_FALSE(d.can_undo());
        expect_same_state(d, document(), "undone");
        for (std::size_t i = 1; i < scenes.size(); ++i) ASSERT_TRUE(d.redo());
        EXPECT_FALSE(d.can_redo());
        expect_same_state(d, document(scenes.back()), "redone");
    }
}

TEST(SceneDocument, UndoOfValuesGivesTheSameBits) {
    SceneDocument d = document();
    const std::vector<float> first = d.program().fields[0].coefficients;
    for (int i = 0; i < 5; ++i) ASSERT_TRUE(d.set_color("rim", Part::left, 0, {0.1 * i, 0.5, 0.2, 1}));
    const std::vector<float> last = d.program().fields[0].coefficients;
    EXPECT_NE(first, last);
    while (d.can_undo()) ASSERT_TRUE(d.undo());
    EXPECT_EQ(d.program().fields[0].coefficients, first);
    while (d.can_redo()) ASSERT_TRUE(d.redo());
    EXPECT_EQ(d.program().fields[0].coefficients, last);
}

TEST(SceneDocument, AGroupIsOneStepAndHistoryIsBounded) {
    SceneDocument d = document(scene(), {.undo_limit = 3});
    const std::string first = d.scene();
    d.begin_group();
    for (int i = 0; i < 20; ++i) ASSERT_TRUE(d.set_height("rim", Part::left, 0, 0.01 * i));
    EXPECT_FALSE(d.can_undo());
    EXPECT_FALSE(d.undo());
    EXPECT_FALSE(d.end_group().value().rebuilt);
    ASSERT_TRUE(d.undo());
    EXPECT_EQ(d.scene(), first);
    EXPECT_FALSE(d.can_undo());
    for (int i = 0; i < 10; ++i) ASSERT_TRUE(d.set_height("rim", Part::left, 0, 0.02 * (i + 1)));
    EXPECT_FALSE(d.can_redo());
    int undone = 0;
    while (d.can_undo()) {
        ASSERT_TRUE(d.undo());
        ++undone;
    }
    EXPECT_EQ(undone, 3);
    EXPECT_EQ(d.undo().error().kind(), ErrorKind::usage);
}

TEST(SceneDocument, StopsThatAreDraggedWaitForTheEndOfTheGroup) {
    SceneDocument d = document();
    const auto drag_to = [&](double t) {
        return d.set_stops("rim", Part::right, {{0, {{0, 0, 1, 1}}, 0.0}, {t, {{0, 1, 0, 1}}, 0.02}});
    };
    const std::vector<std::array<float, 3>> base = d.program().base;
    d.begin_group();
    std::vector<float> last = d.program().fields[0].coefficients;
    for (double t : {0.45, 0.4, 0.3}) {
        const Result<Change> change = drag_to(t);
        ASSERT_TRUE(change);
        EXPECT_FALSE(change.value().rebuilt);
        EXPECT_EQ(d.program().base, base);
        EXPECT_NE(d.program().fields[0].coefficients, last);
        last = d.program().fields[0].coefficients;
    }
    // The kinks are off by less than an edge, and so are the values by less than they change along one.
    const SceneDocument fresh = document(json::parse(d.scene()));
    const auto mean = [](const SceneDocument& of) {
        double sum = 0;
        const std::vector<float> values = evaluate_on_cpu(of.program()).values[0];
        for (float x : values) sum += x;
        return sum / static_cast<double>(values.size());
    };
    EXPECT_NEAR(mean(d), mean(fresh), 0.01);
    const Result<Change> end = d.end_group();
    ASSERT_TRUE(end);
    EXPECT_TRUE(end.value().rebuilt);
    expect_same_state(d, fresh, "end of the group");
    ASSERT_TRUE(d.undo());
    expect_same_state(d, document(), "undone");
}

TEST(SceneDocument, WhatFailsChangesNothingAndSaysWhy) {
    SceneDocument d = document();
    const std::string before = d.scene();
    const std::vector<float> coefficients = d.program().fields[0].coefficients;
    const auto expect_refused = [&](const Result<Change>& change, const std::string& why) {
        ASSERT_FALSE(change);
        EXPECT_NE(std::string(change.error().what()).find(why), std::string::npos) << change.error().what();
        EXPECT_EQ(d.scene(), before);
        EXPECT_EQ(d.program().fields[0].coefficients, coefficients);
        EXPECT_FALSE(d.can_undo());
    };
    expect_refused(d.set_color("rimm", Part::left, 0, {1, 1, 1, 1}), "did you mean \"rim\"");
    expect_refused(d.set_color("rim", Part::left, 1, {1, 1, 1, 1}), "expected a stop below 1 (\"left\" has 1 stop), found 1");
    expect_refused(d.set_color("rim", Part::jump, 0, {1, 1, 1, 1}), "expected a poisson_curve, found a diffusion_curve");
    expect_refused(d.set_color("rim", Part::left, 0, {NAN, 1, 1, 1}), "/layers/0/primitives/0/left/color");
    expect_refused(d.set_height("rim", Part::left, 0, INFINITY), "/layers/0/primitives/0/left/height");
    expect_refused(d.move_point("rim", 1, {0, 0, 0}), "expected a point below 1");
    expect_refused(d.set_stops("rim", Part::left, {{0.5, {}, 1.0}, {0.2, {}, 1.0}}), "ascending");
    expect_refused(d.add(3, "{}"), "expected a layer below 1, found 3");
    expect_refused(d.add(0, "{\"kind\": "), "the added primitive");
    expect_refused(d.set("rim.path.radius=-1"), "/layers/0/primitives/0/path/radius");
    expect_refused(d.set("rim.id=base"), "unique id");
    // Found out only by the build: without diffusion curves the region has nothing to stand on.
    d.begin_group();
    ASSERT_TRUE(d.remove("rim"));
    const Result<Change> last = d.remove("base");
    ASSERT_FALSE(last);
    EXPECT_NE(std::string(last.error().what()).find("needs at least one diffusion curve"), std::string::npos);
    EXPECT_TRUE(d.set_height("base", Part::left, 0, 0.2));
    expect_same_state(d, document(json::parse(d.scene())), "after a failed build");
}

TEST(SceneDocument, OtherBasesAndColourSpaces) {
    for (const char* basis : {"green", "exact"}) {
        json content = scene();
        content["basis"] = {{"kind", basis}};
        SceneDocument d = document(content);
        const Result<Change> change = d.set_color("rim", Part::right, 0, {0.5, 0.1, 0.9, 1});
        ASSERT_TRUE(change) << basis;
        EXPECT_FALSE(change.value().rebuilt);
        expect_same_state(d, document(json::parse(d.scene())), basis);
    }
    json content = scene();
    content["color_space"] = "oklab";
    SceneDocument d = document(content);
    ASSERT_TRUE(d.set_color("rim", Part::left, 0, {0.5, 0.1, 0.9, 1}));
    expect_same_state(d, document(json::parse(d.scene())), "oklab");
}

TEST(SceneDocument, PreparedDocumentsSolveNothingMore) {
    SceneDocument d = document();
    const Result<int> solved = d.prepare();
    ASSERT_TRUE(solved);
    EXPECT_EQ(solved.value(), 7);  // rim 1 + 2, base 2, region, jump: colour and height share theirs
    ASSERT_TRUE(d.set_color("rim", Part::left, 0, {0, 1, 0, 1}));
    EXPECT_EQ(d.prepare().value(), 0);
}

TEST(SceneDocument, OutputSaysWhereColoursAre) {
    json content = scene();
    for (json& primitive : content["layers"][0]["primitives"])
        for (const char* side : {"left", "right"})
            if (primitive.contains(side))
                primitive[side] = {{"color", {0.25, 0.5, 0.75}}};
    content["layers"][0]["primitives"].erase(3);
    content["layers"][0]["primitives"].erase(2);
    const SceneDocument d = document(content);
    const Evaluation e = evaluate_on_cpu(d.program());
    ASSERT_EQ(d.output().color_layers.size(), 1u);
    const OutputSurface::ColorLayer& layer = d.output().color_layers[0];
    ASSERT_EQ(layer.row.size(), d.program().base.size());
    EXPECT_EQ(d.output().corner_normal.size(), d.output().faces.size());
    for (std::uint32_t row : layer.row) {
        ASSERT_NE(row, OutputSurface::no_row);
        const std::size_t at = row * d.program().fields[layer.field].table.channels + layer.channel;
        EXPECT_NEAR(e.values[layer.field][at], 0.25f, 1e-6);
        EXPECT_NEAR(e.values[layer.field][at + 2], 0.75f, 1e-6);
    }
    for (const auto& face : d.output().faces)
        for (std::uint32_t v : face) EXPECT_LT(v, d.program().base.size());
}

}  // namespace
}  // namespace pvg
