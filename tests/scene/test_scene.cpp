// What good scenes parse to, --set, values along a curve, and that the schema accepts all of them.
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "scene/json_text.h"
#include "scene/scene.h"
#include "scene/schema.h"

namespace pvg {
namespace {

using nlohmann::json;

Scene parse(const std::string& text, const std::vector<std::string>& assignments = {}) {
    const json document = parse_json_text(text, "good.pvg.json");
    Scene scene = parse_scene(document, "folder/good.pvg.json", assignments);
    EXPECT_EQ(schema_violation(scene.document), std::nullopt) << text;
    return scene;
}

Scene parse_primitive(const std::string& primitive) {
    return parse(R"({"pvg": 1, "mesh": {"file": "m.glb"}, "layers": [{"primitives": [)" + primitive + "]}]}");
}

const std::string circle = R"("path": {"type": "circle", "center": [0, 0, 0], "radius": 0.1})";

TEST(Scene, HasItsDefaults) {
    const Scene scene = parse(R"({"pvg": 1, "mesh": {"file": "m.glb"}, "layers": [{"primitives": []}]})");
    EXPECT_EQ(scene.mesh_file, std::filesystem::path("folder/m.glb"));
    EXPECT_FALSE(scene.mesh_select || scene.max_edge || scene.subdivide);
    EXPECT_TRUE(scene.unit_is_bbox);
    EXPECT_EQ(scene.color_space, ColorSpace::linear);
    EXPECT_EQ(scene.knot_spacing, 0.03);
    EXPECT_EQ(scene.knot_grading, 0.25);
    EXPECT_EQ(scene.basis, BasisKind::local);
    EXPECT_EQ(scene.basis_rings, 2);
    EXPECT_TRUE(scene.basis_normalize);
    ASSERT_EQ(scene.layers.size(), 1u);
    EXPECT_EQ(scene.layers[0].blend, BlendMode::over);
    EXPECT_FALSE(scene.layers[0].on_displaced);
}

TEST(Scene, ReadsEveryTopLevelKey) {
    const Scene scene =
        parse(R"({"pvg": 1, "$schema": "scene.schema.json", "mesh": {"file": "../m.glb", "select": 2, "max_edge": 0.01},
        "length_unit": "mesh", "color_space": "oklab", "knots": {"spacing": 0.02, "grading": 0.5}, "basis": {"kind": "green", "rings": 5, "normalize": false},
        "layers": [{"name": "a", "on": "base", "blend": "add", "primitives": []}, {"blend": "multiply", "primitives": []}]})");
    EXPECT_EQ(scene.mesh_select, "2");
    EXPECT_EQ(scene.max_edge, 0.01);
    EXPECT_FALSE(scene.unit_is_bbox);
    EXPECT_EQ(scene.color_space, ColorSpace::oklab);
    EXPECT_EQ(scene.knot_spacing, 0.02);
    EXPECT_EQ(scene.knot_grading, 0.5);
    EXPECT_EQ(scene.basis, BasisKind::green);
    EXPECT_EQ(scene.basis_rings, 5);
    EXPECT_FALSE(scene.basis_normalize);
    EXPECT_EQ(scene.layers[0].name, "a");
    EXPECT_EQ(scene.layers[0].blend, BlendMode::add);
    EXPECT_EQ(scene.layers[1].blend, BlendMode::multiply);
    EXPECT_EQ(scene.layers[1].pointer, "/layers/1");
}

TEST(Scene, ResolvesAnAbsoluteMeshPath) {
    EXPECT_EQ(parse(R"({"pvg": 1, "mesh": {"file": "/m.glb"}, "layers": [{"primitives": []}]})").mesh_file,
              std::filesystem::path("/m.glb"));
}

TEST(Scene, ReadsSidesOfADiffusionCurve) {
    const Scene scene = parse_primitive(R"({"kind": "diffusion_curve", "id": "c", )" + circle + R"(,
        "left": {"color": "#FF8000"}, "right": [{"t": 0, "color": [0.1, 0.2, 0.3, 0.4], "height": 1}, {"t": 0.5, "height": 2}, {"t": 1, "color": "#00000080"}]})");
    const Primitive& primitive = scene.layers[0].primitives[0];
    EXPECT_EQ(primitive.name(), "\"c\"");
    EXPECT_TRUE(primitive.enabled);
    const auto& curve = std::get<DiffusionCurve>(primitive.shape);
    ASSERT_EQ(curve.left.color.t, std::vector<double>{0});
    EXPECT_TRUE(curve.left.height.empty());
    // 128/255 in sRGB is 0.2158605 in linear light (IEC 61966-2-1).
    EXPECT_NEAR((curve.left.color.value[0] - Color(1, 0.2158605001138992, 0, 1)).norm(), 0, 1e-12);
    EXPECT_EQ(curve.right.color.t, (std::vector<double>{0, 1}));
    EXPECT_EQ(curve.right.color.value[0], Color(0.1, 0.2, 0.3, 0.4));
    EXPECT_EQ(curve.right.color.value[1], Color(0, 0, 0, 128 / 255.0));
    EXPECT_EQ(curve.right.height.t, (std::vector<double>{0, 0.5}));
    EXPECT_EQ(curve.right.height.value, (std::vector<double>{1, 2}));
}

TEST(Scene, BothSetsBothSides) {
    const Scene scene =
        parse_primitive(R"({"kind": "diffusion_curve", "enabled": false, )" + circle + R"(, "both": {"height": 3}})");
    const Primitive& primitive = scene.layers[0].primitives[0];
    EXPECT_FALSE(primitive.enabled);
    EXPECT_EQ(primitive.name(), "/layers/0/primitives/0");
    const auto& curve = std::get<DiffusionCurve>(primitive.shape);
    EXPECT_EQ(curve.left.height.value, std::vector<double>{3});
    EXPECT_EQ(curve.right.height.value, std::vector<double>{3});
    EXPECT_TRUE(curve.left.color.empty() && curve.right.color.empty());
}

TEST(Scene, ReadsPoissonCurvesAndRegions) {
    const Scene scene = parse_primitive(R"({"kind": "poisson_curve", )" + circle +
                                        R"(, "jump": [{"t": 0, "color": [1, -2, 0]}, {"t": 1, "height": -1}], "width": 0.02},
        {"kind": "poisson_region", )" + circle +
                                        R"(, "rise": {"height": 0.1}, "ring": "none"},
        {"kind": "poisson_region", )" + circle +
                                        R"(, "laplacian": {"color": [1, 2, 3], "height": -4e12}, "ring": 0.5},
        {"kind": "poisson_region", )" + circle +
                                        R"(, "rise": {"color": [0, 0, 0]}})");
    const auto& primitives = scene.layers[0].primitives;
    const auto& curve = std::get<PoissonCurve>(primitives[0].shape);
    EXPECT_EQ(curve.color_jump.value[0], Eigen::Vector4d(1, -2, 0, 0));
    EXPECT_EQ(curve.height_jump.t, std::vector<double>{1});
    EXPECT_EQ(curve.width, 0.02);
    const auto& rise = std::get<PoissonRegion>(primitives[1].shape);
    EXPECT_TRUE(rise.by_rise);
    EXPECT_FALSE(rise.color || rise.ring);
    EXPECT_EQ(rise.height, 0.1);
    const auto& laplacian = std::get<PoissonRegion>(primitives[2].shape);
    EXPECT_FALSE(laplacian.by_rise);
    EXPECT_EQ(*laplacian.color, Eigen::Vector4d(1, 2, 3, 0));
    EXPECT_EQ(laplacian.height, -4e12);
    EXPECT_EQ(laplacian.ring, 0.5);
    EXPECT_EQ(std::get<PoissonRegion>(primitives[3].shape).ring, 0.2);
}

TEST(Scene, ReadsPaths) {
    const Scene scene = parse_primitive(
        R"({"kind": "diffusion_curve", "both": {"height": 0}, "path": {"type": "bezier", "degree": 2, "closed": true, "parameter": "curve", "snap": "any",
                "points": [[0, 0, 0], [1, 0, 0], {"face": 7, "bary": [0.25, 0.25, 0.5]}, [0, 1, 0]]}},
           {"kind": "diffusion_curve", "both": {"height": 0}, "path": {"type": "circle", "center": [1, 2, 3], "radius": 0.5, "start": [4, 5, 6], "closed": true}},
           {"kind": "diffusion_curve", "both": {"height": 0}, "path": {"type": "bspline", "points": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]}})");
    const auto path = [&](int i) { return std::get<DiffusionCurve>(scene.layers[0].primitives[i].shape).path; };
    EXPECT_EQ(path(0).kind, PathKind::bezier);
    EXPECT_EQ(path(0).degree, 2);
    EXPECT_TRUE(path(0).closed && path(0).parameter_curve && path(0).snap_any);
    EXPECT_TRUE(path(0).points[2].on_face);
    EXPECT_EQ(path(0).points[2].face, 7);
    EXPECT_EQ(path(0).points[2].bary, Eigen::Vector3d(0.25, 0.25, 0.5));
    EXPECT_EQ(path(0).points[2].pointer, "/layers/0/primitives/0/path/points/2");
    EXPECT_EQ(path(1).kind, PathKind::circle);
    EXPECT_TRUE(path(1).closed);
    EXPECT_EQ(path(1).center.position, Eigen::Vector3d(1, 2, 3));
    EXPECT_EQ(path(1).start->position, Eigen::Vector3d(4, 5, 6));
    EXPECT_EQ(path(2).degree, 3);
    EXPECT_FALSE(path(2).closed || path(2).parameter_curve || path(2).snap_any);
}

TEST(Scene, TheProjectsOwnScenesAreGood) {
    int count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(PVG_SCENES_FOLDER)) {
        if (!entry.path().string().ends_with(".pvg.json"))
            continue;
        const Scene scene = read_scene(entry.path());
        EXPECT_EQ(schema_violation(scene.document), std::nullopt) << entry.path();
        ++count;
    }
    EXPECT_GE(count, 4);
}

TEST(Scene, TheSchemaInsideIsThePublishedFile) {
    EXPECT_EQ(scene_schema(), read_text_file(std::filesystem::path(PVG_SCENES_FOLDER) / "scene.schema.json"));
}

TEST(Set, ReplacesAddsIndexesAndAppends) {
    const std::string text = R"({"pvg": 1, "mesh": {"file": "m.glb"}, "layers": [{"primitives": [
        {"kind": "diffusion_curve", "id": "rim", "path": {"type": "polyline", "points": [[0, 0, 0], [1, 0, 0]]}, "left": {"color": "#000000"}},
        {"kind": "diffusion_curve", "id": "a.b=c", )" +
                             circle + R"(, "left": [{"t": 0, "height": 1}]}]}]})";
    const Scene scene =
        parse(text, {"rim.left.color=#ffffff", "rim.right.height=2.5", "rim.path.points.1.2=7", "rim.path.points.2=[9,9,9]",
                     "rim.enabled=false", "a.b=c.left.0.height=4", "a.b=c.left.1={\"t\":1,\"height\":5}"});
    const Primitive& rim = scene.layers[0].primitives[0];
    const auto& curve = std::get<DiffusionCurve>(rim.shape);
    EXPECT_NEAR((curve.left.color.value[0] - Color(1, 1, 1, 1)).norm(), 0, 1e-15);
    EXPECT_EQ(curve.right.height.value[0], 2.5);
    EXPECT_EQ(curve.path.points[1].position, Eigen::Vector3d(1, 0, 7));
    EXPECT_EQ(curve.path.points[2].position, Eigen::Vector3d(9, 9, 9));
    EXPECT_FALSE(rim.enabled);
    EXPECT_EQ(std::get<DiffusionCurve>(scene.layers[0].primitives[1].shape).left.height.value, (std::vector<double>{4, 5}));
    // What is embedded in the asset is the edited document.
    EXPECT_EQ(scene.document["layers"][0]["primitives"][0]["right"]["height"], 2.5);
}

TEST(Set, NamesWhatIsWrong) {
    const std::string text = R"({"pvg": 1, "mesh": {"file": "m.glb"}, "layers": [{"primitives": [
        {"kind": "diffusion_curve", "id": "rim", )" +
                             circle + R"(, "left": {"height": 1}}, {"kind": "diffusion_curve", "id": "petal", )" + circle +
                             R"(, "left": {"height": 1}}]}]})";
    const auto fails = [&](const std::string& assignment, ErrorKind kind, const std::string& message) {
        try {
            parse(text, {assignment});
            ADD_FAILURE() << assignment;
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), kind) << assignment;
            EXPECT_EQ(error.what(), message);
        }
    };
    fails("rim", ErrorKind::usage, "--set rim: expected ID.KEY[.KEY...]=VALUE");
    fails("rim.left", ErrorKind::usage, "--set rim.left: expected ID.KEY[.KEY...]=VALUE");
    fails("rim=3", ErrorKind::usage, "--set rim=3: expected ID.KEY[.KEY...]=VALUE");
    fails("petl.left.height=2", ErrorKind::usage,
          "--set petl.left.height=2: no primitive of folder/good.pvg.json has the id \"petl\", did you mean \"petal\"?; the ids "
          "are \"rim\", \"petal\"");
    fails("rim.path.center.4=2", ErrorKind::usage,
          "--set rim.path.center.4=2: expected an index from 0 to 3 into rim.path.center, found \"4\"");
    fails("rim.left.height.x=2", ErrorKind::usage, "--set rim.left.height.x=2: rim.left.height is 1 and has no key \"x\"");
    fails("rim..x=2", ErrorKind::usage, "--set rim..x=2: expected a key between the dots, found none");
    fails("rim.left.color=redd", ErrorKind::bad_input,
          "folder/good.pvg.json: /layers/0/primitives/0/left/color: expected \"#rrggbb\" or [r,g,b], found \"redd\"");
}

TEST(Stops, AnOpenCurveIsConstantBeyondThem) {
    const Stops<double> stops{{0.25, 0.75}, {1, 3}};
    EXPECT_EQ(evaluate_stops(stops, 0, false), 1);
    EXPECT_EQ(evaluate_stops(stops, 0.25, false), 1);
    EXPECT_DOUBLE_EQ(evaluate_stops(stops, 0.5, false), 2);
    EXPECT_EQ(evaluate_stops(stops, 0.75, false), 3);
    EXPECT_EQ(evaluate_stops(stops, 1, false), 3);
}

TEST(Stops, AClosedCurveIsPeriodic) {
    const Stops<double> stops{{0.25, 0.75}, {1, 3}};
    EXPECT_DOUBLE_EQ(evaluate_stops(stops, 0, true), 2);
    EXPECT_DOUBLE_EQ(evaluate_stops(stops, 1, true), 2);
    EXPECT_DOUBLE_EQ(evaluate_stops(stops, 0.875, true), 2.5);
    EXPECT_DOUBLE_EQ(evaluate_stops(stops, 0.125, true), 1.5);
    for (double t = 0; t < 1; t += 0.0625) EXPECT_DOUBLE_EQ(evaluate_stops(stops, t, true), evaluate_stops(stops, t + 1, true));
}

TEST(Stops, BothEndsOfAClosedCurveMakeAJumpAtTheSeam) {
    const Stops<double> stops{{0, 1}, {5, 7}};
    EXPECT_EQ(evaluate_stops(stops, 0, true), 5);
    EXPECT_EQ(evaluate_stops(stops, 1, true), 5);
    EXPECT_NEAR(evaluate_stops(stops, 1 - 1e-9, true), 7, 1e-8);
    EXPECT_EQ(evaluate_stops(stops, 1, false), 7);
}

TEST(Stops, OneValueHoldsEverywhere) {
    const Stops<Color> stops{{0.5}, {Color(1, 2, 3, 4)}};
    for (const bool closed : {false, true}) {
        for (const double t : {0.0, 0.3, 0.5, 0.9, 1.0}) EXPECT_EQ(evaluate_stops(stops, t, closed), Color(1, 2, 3, 4));
    }
}

}  // namespace
}  // namespace pvg
