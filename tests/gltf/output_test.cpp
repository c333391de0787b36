// What is written: seams, interpolation, colours and materials, fields, walls, skins, and everything else left as it was.
#include <cstring>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "gltf/fixtures.h"
#include "gltf/validator.h"
#include "mesh/subdivide.h"

namespace pvg::test {
namespace {

constexpr int real = 5126, u8 = 5121, u16 = 5123;

/// A unit cube with a vertex for each corner of each side: split normals and texture seams. 24 vertices, 12 triangles.
Draft cube() {
    Draft draft;
    std::vector<float> points, normals, texcoords;
    std::vector<std::uint16_t> indices;
    for (int axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 2; ++side) {
            const auto first = static_cast<std::uint16_t>(points.size() / 3);
            for (int corner = 0; corner < 4; ++corner) {
                const int a = corner & 1, b = corner >> 1;
                std::array<float, 3> p{}, n{};
                p[axis] = static_cast<float>(side);
                p[(axis + 1) % 3] = static_cast<float>(a);
                p[(axis + 2) % 3] = static_cast<float>(b);
                n[axis] = side ? 1.0f : -1.0f;
                points.insert(points.end(), p.begin(), p.end());
                normals.insert(normals.end(), n.begin(), n.end());
                texcoords.push_back(static_cast<float>(a));
                texcoords.push_back(static_cast<float>(b));
            }
            const std::array<std::uint16_t, 6> outwards{0, 1, 3, 0, 3, 2}, inwards{0, 3, 1, 0, 2, 3};
            for (std::uint16_t i : side ? outwards : inwards) indices.push_back(static_cast<std::uint16_t>(first + i));
        }
    const Json attributes = {{"POSITION", draft.positions(points)},
                             {"NORMAL", draft.accessor(normals, real, "VEC3", 3)},
                             {"TEXCOORD_0", draft.accessor(texcoords, real, "VEC2", 2)}};
    draft.one_mesh(attributes);
    draft.json["meshes"][0]["primitives"][0]["indices"] = draft.accessor(indices, u16, "SCALAR", 1);
    return draft;
}

/// The triangle (0,0,0) (1,0,0) (0,1,0).
Draft triangle() {
    Draft draft;
    draft.one_mesh({{"POSITION", draft.positions({0, 0, 0, 1, 0, 0, 0, 1, 0})}});
    return draft;
}

const Json& attribute(const Json& json, const char* name, std::size_t primitive = 0) {
    return json["meshes"][0]["primitives"][primitive]["attributes"][name];
}

std::vector<float> floats(const std::filesystem::path& glb, const char* name, std::size_t primitive = 0) {
    return values_of<float>(glb, attribute(json_of(glb), name, primitive).get<std::size_t>());
}

void expect_valid(const std::filesystem::path& file) {
    if (!has_validator())
        return;
    EXPECT_EQ(validator_errors({file}), "");
}

TEST(Output, CubeWeldsToEightAndKeepsItsSeams) {
    Folder folder;
    Draft draft = cube();
    Opened opened(draft.write(folder));
    ASSERT_EQ(opened.welded.surface.vertex_count(), 8);
    DecoratedMesh mesh = opened.lifted(0.1);
    mesh.corner_normal.assign(mesh.faces.size(), {none, none, none});  // the sides stay flat
    opened.write(folder / "out.glb", mesh);
    const auto points = floats(folder / "out.glb", "POSITION"), normals = floats(folder / "out.glb", "NORMAL"),
               texcoords = floats(folder / "out.glb", "TEXCOORD_0");
    ASSERT_EQ(points.size(), 24u * 3);
    // Every output vertex is one of the input's 24 with its own normal and texture coordinates, moved along the diagonal.
    std::set<std::vector<float>> distinct;
    for (std::size_t v = 0; v < 24; ++v) {
        std::vector<float> all(normals.begin() + 3 * v, normals.begin() + 3 * v + 3);
        all.insert(all.end(), texcoords.begin() + 2 * v, texcoords.begin() + 2 * v + 2);
        distinct.insert(all);
        for (int c = 0; c < 3; ++c) {
            const float rounded = std::round(points[3 * v + c]);
            EXPECT_NEAR(std::abs(points[3 * v + c] - rounded), 0.1 / std::sqrt(3.0), 1e-6);  // float rounding of a unit cube
        }
    }
    EXPECT_EQ(distinct.size(), 24u);
    expect_valid(folder / "out.glb");
}

TEST(Output, SmoothNormalsKeepTextureSeams) {
    Folder folder;
    Draft draft = cube();
    Opened opened(draft.write(folder));
    opened.write(folder / "out.glb", opened.lifted(0.1));
    EXPECT_EQ(floats(folder / "out.glb", "POSITION").size(), 24u * 3);
    const auto normals = floats(folder / "out.glb", "NORMAL");
    for (std::size_t v = 0; v < 24; ++v)
        EXPECT_NEAR(Point(normals[3 * v], normals[3 * v + 1], normals[3 * v + 2]).norm(), 1, 1e-6);  // float rounding
    expect_valid(folder / "out.glb");
}

TEST(Output, ImprintedVerticesInterpolateEveryAttribute) {
    Folder folder;
    Draft draft = triangle();
    Json& attributes = draft.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["TEXCOORD_0"] = draft.accessor<float>({0, 0, 4, 0, 0, 8}, real, "VEC2", 2);
    attributes["TEXCOORD_1"] = draft.accessor<std::uint8_t>({0, 0, 0, 0, 255, 0, 0, 0, 0, 255, 0, 0}, u8, "VEC2", 2, true);
    // Two-byte elements, padded to four: shorten the declared count's stride by hand.
    draft.json["accessors"].back()["count"] = 3;
    draft.json["bufferViews"].back()["byteStride"] = 4;
    attributes["_HEAT"] = draft.accessor<float>({10, 20, 40}, real, "SCALAR", 1);
    attributes["_ID"] = draft.accessor<std::uint16_t>({7, 0, 9, 0, 11, 0}, u16, "SCALAR", 1);
    draft.json["accessors"].back()["count"] = 3;
    draft.json["bufferViews"].back()["byteStride"] = 4;
    draft.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", draft.positions({0, 0, 1, 0, 0, 3, 0, 0, 5})}}};
    draft.json["meshes"][0]["weights"] = {0.5};
    Opened opened(draft.write(folder));
    // One vertex at the barycentric point (1/2, 1/4, 1/4).
    DecoratedMesh mesh = opened.identity();
    mesh.position.push_back({0.25f, 0.25f, 0});
    mesh.base.push_back(mesh.position.back());
    mesh.origin.push_back({{0, 1, 2}, {0.5, 0.25, 0.25}});
    mesh.decorated = {0, 0, 0, 1};
    mesh.color_decorated = mesh.decorated;
    mesh.moved.push_back(0);
    mesh.color.assign(4, {0.5f, 1, 0, 1});
    mesh.faces = {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    mesh.raw_face = {0, 0, 0};
    mesh.corner_normal.assign(3, {none, none, none});
    opened.write(folder / "out.glb", mesh);
    const auto out = folder / "out.glb";
    const Json json = json_of(out);
    const auto points = floats(out, "POSITION"), texcoords = floats(out, "TEXCOORD_0"), second = floats(out, "TEXCOORD_1"),
               heat = floats(out, "_HEAT");
    const auto colors = values_of<std::uint16_t>(out, attribute(json, "COLOR_0").get<std::size_t>()),
               ids = values_of<std::uint16_t>(out, attribute(json, "_ID").get<std::size_t>());
    const auto deltas = values_of<float>(out, json["meshes"][0]["primitives"][0]["targets"][0]["POSITION"].get<std::size_t>());
    ASSERT_EQ(points.size(), 4u * 3);
    std::size_t fresh = 4;
    for (std::size_t v = 0; v < 4; ++v)
        if (points[3 * v] == 0.25f)
            fresh = v;
    ASSERT_LT(fresh, 4u);
    EXPECT_EQ(texcoords[2 * fresh], 1.0f);
    EXPECT_EQ(texcoords[2 * fresh + 1], 2.0f);
    EXPECT_EQ(second[2 * fresh], 0.25f);
    EXPECT_EQ(heat[fresh], 20.0f);
    EXPECT_EQ(ids[2 * fresh], 7) << "identifiers do not average";
    EXPECT_EQ(deltas[3 * fresh + 2], 2.5f);
    EXPECT_EQ(colors[4 * fresh], 32768);  // 0.5 of 65535, rounded half away
    EXPECT_EQ(colors[4 * fresh + 1], 65535);
    for (std::size_t v = 0; v < 4; ++v)
        if (v != fresh) {
            for (int c = 0; c < 4; ++c) EXPECT_EQ(colors[4 * v + c], 65535) << "undecorated vertices stay white";
        }
    expect_valid(out);
}

TEST(Output, UndecoratedVerticesKeepTheirBits) {
    Folder folder;
    Draft draft = cube();
    std::vector<std::uint8_t> rgba;
    for (int v = 0; v < 24; ++v)
        for (int c = 0; c < 4; ++c) rgba.push_back(static_cast<std::uint8_t>(10 * v + c));
    draft.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = draft.accessor(rgba, u8, "VEC4", 4, true);
    Opened opened(draft.write(folder));
    DecoratedMesh mesh = opened.lifted(0.1);
    for (int v = 0; v < 7; ++v) mesh.decorated[v] = mesh.color_decorated[v] = mesh.moved[v] = 0;
    opened.write(folder / "out.glb", mesh);
    const auto out = folder / "out.glb";
    const auto points = floats(out, "POSITION"), normals = floats(out, "NORMAL");
    const auto colors = values_of<std::uint16_t>(out, attribute(json_of(out), "COLOR_0").get<std::size_t>());
    const Point moved = opened.welded.surface.point(7);
    std::set<std::vector<float>> input, output;
    for (std::size_t v = 0; v < 24; ++v) {
        const Point& p = opened.asset.mesh().points[v];
        if (p == moved)
            continue;
        const Point& n = opened.asset.mesh().normals[v];
        std::vector<float> all{static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]),
                               static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])};
        for (int c = 0; c < 4; ++c) all.push_back(static_cast<float>(rgba[4 * v + c] * 257));
        input.insert(all);
    }
    for (std::size_t v = 0; 3 * v < points.size(); ++v) {
        std::vector<float> all(points.begin() + 3 * v, points.begin() + 3 * v + 3);
        all.insert(all.end(), normals.begin() + 3 * v, normals.begin() + 3 * v + 3);
        for (int c = 0; c < 4; ++c) all.push_back(colors[4 * v + c]);
        output.insert(all);
    }
    EXPECT_EQ(input.size(), 21u);
    for (const auto& vertex : input) EXPECT_TRUE(output.count(vertex));
    EXPECT_EQ(output.size(), 24u);
    expect_valid(out);
}

TEST(Output, ColorIsReplacedAlphaAndFactorStay) {
    Folder folder;
    Draft draft = triangle();
    draft.json["materials"] = {{{"name", "paint"},
                                {"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.25, 1.0, 0.5}}, {"roughnessFactor", 0.3}}},
                                {"alphaMode", "BLEND"},
                                {"extras", {{"keep", 1}}}}};
    draft.json["meshes"][0]["primitives"][0]["material"] = 0;
    draft.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = draft.accessor<std::uint16_t>(
        {65535, 65535, 65535, 0, 65535, 65535, 65535, 13107, 65535, 65535, 65535, 65535}, u16, "VEC4", 4, true);
    Opened opened(draft.write(folder));
    DecoratedMesh mesh = opened.identity();
    mesh.decorated = mesh.color_decorated = {0, 1, 1};
    mesh.color.assign(3, {1, 0, 0.5f, 0.123f});
    opened.write(folder / "out.glb", mesh);
    const Json json = json_of(folder / "out.glb");
    const auto colors = values_of<std::uint16_t>(folder / "out.glb", attribute(json, "COLOR_0").get<std::size_t>());
    EXPECT_EQ(colors, (std::vector<std::uint16_t>{32768, 16384, 65535, 0, 65535, 0, 32768, 13107, 65535, 0, 32768, 65535}));
    ASSERT_EQ(json["materials"].size(), 2u);
    EXPECT_EQ(json["materials"][0], draft.json["materials"][0]) << "the material itself may belong to others";
    const auto used = json["meshes"][0]["primitives"][0]["material"].get<std::size_t>();
    EXPECT_EQ(used, 1u);
    EXPECT_EQ(json["materials"][used]["pbrMetallicRoughness"]["baseColorFactor"], Json({1, 1, 1, 0.5}));
    EXPECT_EQ(json["materials"][used]["pbrMetallicRoughness"]["roughnessFactor"], 0.3);
    EXPECT_EQ(json["materials"][used]["extras"]["keep"], 1);
    expect_valid(folder / "out.glb");
}

TEST(Output, NoMaterialBecomesWhiteAndNotMetallic) {
    Folder folder;
    Opened opened(triangle().write(folder));
    opened.write(folder / "out.glb", opened.lifted(0.5));
    const Json json = json_of(folder / "out.glb");
    const Json& material = json["materials"][json["meshes"][0]["primitives"][0]["material"].get<std::size_t>()];
    EXPECT_EQ(material["pbrMetallicRoughness"]["metallicFactor"], 0);
    EXPECT_EQ(material["pbrMetallicRoughness"]["baseColorFactor"], Json({1, 1, 1, 1}));
    expect_valid(folder / "out.glb");
}

TEST(Output, BoundsAreExactFloats) {
    Folder folder;
    Opened opened(triangle().write(folder));
    opened.write(folder / "out.glb", opened.lifted(0.1));
    const Json json = json_of(folder / "out.glb");
    const Json& accessor = json["accessors"][attribute(json, "POSITION").get<std::size_t>()];
    EXPECT_EQ(accessor["max"][2].get<double>(), static_cast<double>(0.1f));
    EXPECT_EQ(accessor["min"][2].get<double>(), static_cast<double>(0.1f));
}

TEST(Output, FieldsAreFloatAttributes) {
    Folder folder;
    Opened opened(cube().write(folder));
    DecoratedMesh mesh = opened.lifted(0.1);
    for (std::size_t v = 0; v < 8; ++v) {
        mesh.field_color[v] = {2.0f, -1.0f, 0.5f, 1.0f};
        mesh.field_height[v] = static_cast<float>(v);
        mesh.dirichlet[v] = {1, 0};
        mesh.cell[v] = {static_cast<float>(v), -1};
    }
    WriteOptions options;
    options.fields = true;
    opened.write(folder / "out.glb", mesh, options);
    const auto out = folder / "out.glb";
    const Json json = json_of(out);
    EXPECT_EQ(json["accessors"][attribute(json, "COLOR_0").get<std::size_t>()]["componentType"], real);
    const auto color = floats(out, "_PVG_COLOR"), height = floats(out, "_PVG_HEIGHT"), cell = floats(out, "_PVG_CELL"),
               base = floats(out, "_PVG_BASE"), dirichlet = floats(out, "_PVG_DIRICHLET");
    ASSERT_EQ(height.size(), 24u);
    for (std::size_t v = 0; v < 24; ++v) {
        EXPECT_EQ(color[4 * v], 2.0f) << "before clamping";
        EXPECT_EQ(height[v], cell[2 * v]);
        EXPECT_EQ(cell[2 * v + 1], -1.0f);
        EXPECT_EQ(dirichlet[2 * v], 1.0f);
        const Point& p = opened.welded.surface.point(static_cast<int>(height[v]));
        for (int c = 0; c < 3; ++c) EXPECT_EQ(base[3 * v + c], static_cast<float>(p[c]));
    }
    expect_valid(out);
    // Nothing reached: the fields are there, all else is as it was.
    opened.write(folder / "plain.glb", opened.identity(), options);
    for (float value : floats(folder / "plain.glb", "_PVG_COLOR")) EXPECT_EQ(value, 0.0f);
    const Json plain = json_of(folder / "plain.glb");
    EXPECT_EQ(attribute(plain, "POSITION"), cube().json["meshes"][0]["primitives"][0]["attributes"]["POSITION"]);
    EXPECT_FALSE(plain["meshes"][0]["primitives"][0]["attributes"].contains("COLOR_0"));
    expect_valid(folder / "plain.glb");
}

TEST(Output, WallsHaveTheirOwnVerticesAndFlatNormals) {
    Folder folder;
    Opened opened(cube().write(folder));
    DecoratedMesh mesh = opened.lifted(0.0);
    mesh.color[mesh.faces[0][1]] = {0, 0, 1, 1};
    DecoratedMesh::Wall wall;
    wall.vertex = {mesh.faces[0][0], mesh.faces[0][1], mesh.faces[0][2]};
    wall.normal = {0, 0, 2};  // written as a unit vector
    wall.raw_face = mesh.raw_face[0];
    mesh.walls = {wall};
    opened.write(folder / "out.glb", mesh);
    const auto points = floats(folder / "out.glb", "POSITION"), normals = floats(folder / "out.glb", "NORMAL");
    const Json json = json_of(folder / "out.glb");
    const auto colors = values_of<std::uint16_t>(folder / "out.glb", attribute(json, "COLOR_0").get<std::size_t>());
    const auto indices =
        values_of<std::uint16_t>(folder / "out.glb", json["meshes"][0]["primitives"][0]["indices"].get<std::size_t>());
    ASSERT_EQ(points.size(), 27u * 3);
    EXPECT_EQ(json["accessors"][json["meshes"][0]["primitives"][0]["indices"].get<std::size_t>()]["count"], 13 * 3);
    std::map<int, int> uses;
    for (int i = 0; i < 39; ++i) ++uses[indices[i]];
    for (int k = 36; k < 39; ++k) {
        EXPECT_EQ(uses[indices[k]], 1);
        EXPECT_EQ(normals[3 * indices[k] + 2], 1.0f);
    }
    EXPECT_EQ(colors[4 * indices[37] + 2], 65535);
    EXPECT_EQ(colors[4 * indices[36] + 2], 0);
    expect_valid(folder / "out.glb");
}

TEST(Output, OnlyDecoratedPrimitivesChange) {
    Folder folder;
    Draft draft;
    const auto a = draft.positions({0, 0, 0, 1, 0, 0, 0, 1, 0}), b = draft.positions({5, 0, 0, 6, 0, 0, 5, 1, 0}),
               c = draft.positions({0, 0, 0, 1, 0, 0, 0, 0, 9});
    draft.one_mesh({{"POSITION", a}});
    draft.json["materials"] = {{{"name", "old"}}};
    Json& primitives = draft.json["meshes"][0]["primitives"];
    primitives.push_back({{"attributes", {{"POSITION", b}}}, {"material", 0}});
    primitives.push_back({{"attributes", {{"POSITION", c}}}, {"mode", 0}});
    primitives.push_back({{"attributes", {{"POSITION", a}}}, {"mode", 1}});
    Opened opened(draft.write(folder));
    ASSERT_EQ(opened.welded.surface.face_count(), 2);
    DecoratedMesh mesh = opened.lifted(0.5);
    for (int v = 3; v < 6; ++v) mesh.decorated[v] = mesh.color_decorated[v] = mesh.moved[v] = 0;
    opened.write(folder / "out.glb", mesh);
    const Json json = json_of(folder / "out.glb");
    for (std::size_t p = 1; p < 4; ++p) EXPECT_EQ(json["meshes"][0]["primitives"][p], primitives[p]);
    EXPECT_NE(json["meshes"][0]["primitives"][0], primitives[0]);
    for (std::size_t i = 0; i < draft.json["accessors"].size(); ++i)
        EXPECT_EQ(json["accessors"][i], draft.json["accessors"][i]) << "shared accessors are copied";
    expect_valid(folder / "out.glb");
}

TEST(Output, SharedBorderIsWrittenInEachPrimitive) {
    Folder folder;
    Draft draft;
    draft.one_mesh({{"POSITION", draft.positions({0, 0, 0, 1, 0, 0, 0, 1, 0})}});
    draft.json["meshes"][0]["primitives"].push_back(
        {{"attributes", {{"POSITION", draft.positions({1, 0, 0, 1, 1, 0, 0, 1, 0})}}}});
    Opened opened(draft.write(folder));
    ASSERT_EQ(opened.welded.surface.vertex_count(), 4);
    opened.write(folder / "out.glb", opened.lifted(0.25));
    for (std::size_t p = 0; p < 2; ++p) {
        const auto points = floats(folder / "out.glb", "POSITION", p);
        ASSERT_EQ(points.size(), 9u);
        for (int v = 0; v < 3; ++v) EXPECT_EQ(points[3 * v + 2], 0.25f);
    }
}

TEST(Output, TangentsFollowTheSurface) {
    Folder folder;
    Draft draft = triangle();
    Json& attributes = draft.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["NORMAL"] = draft.accessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}, real, "VEC3", 3);
    attributes["TANGENT"] = draft.accessor<float>({1, 0, 0, -1, 1, 0, 0, -1, 1, 0, 0, -1}, real, "VEC4", 4);
    attributes["TEXCOORD_0"] = draft.accessor<float>({0, 0, 0, 1, 1, 0}, real, "VEC2", 2);  // u grows along y
    Opened opened(draft.write(folder));
    opened.write(folder / "out.glb", opened.lifted(0.5));
    const auto tangents = floats(folder / "out.glb", "TANGENT");
    for (int v = 0; v < 3; ++v) {
        EXPECT_NEAR(tangents[4 * v + 1], 1, 1e-6);  // float rounding
        EXPECT_EQ(tangents[4 * v + 3], -1.0f);
    }
    expect_valid(folder / "out.glb");
    attributes.erase("TEXCOORD_0");
    Opened without(draft.write(folder));
    without.write(folder / "without.glb", without.lifted(0.5));
    EXPECT_FALSE(json_of(folder / "without.glb")["meshes"][0]["primitives"][0]["attributes"].contains("TANGENT"));
    ASSERT_FALSE(without.warnings.empty());
    EXPECT_NE(without.warnings.back().find("tangents"), std::string::npos);
}

TEST(Output, InfluencesMergeAndSumToOne) {
    Folder folder;
    Draft draft = triangle();
    Json& attributes = draft.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = draft.accessor<std::uint8_t>({0, 1, 2, 3, 4, 5, 0, 0, 6, 0, 0, 0}, u8, "VEC4", 4);
    attributes["WEIGHTS_0"] =
        draft.accessor<float>({0.4f, 0.3f, 0.2f, 0.1f, 0.5f, 0.4f, 0.1f, 0, 0.5f, 0, 0, 0}, real, "VEC4", 4);
    for (int n = 0; n < 7; ++n) draft.json["nodes"].push_back(Json::object());
    draft.json["nodes"][0]["skin"] = 0;
    draft.json["nodes"][1]["children"] = {2, 3, 4, 5, 6, 7};
    draft.json["scenes"][0]["nodes"] = {0, 1};
    draft.json["skins"] = {{{"joints", {1, 2, 3, 4, 5, 6, 7}}}};
    Opened opened(draft.write(folder));
    opened.write(folder / "out.glb", opened.refined(subdivide(opened.welded.surface, 1)));
    const auto weights = floats(folder / "out.glb", "WEIGHTS_0");
    const auto joints =
        values_of<std::uint8_t>(folder / "out.glb", attribute(json_of(folder / "out.glb"), "JOINTS_0").get<std::size_t>());
    ASSERT_EQ(weights.size(), 6u * 4);
    for (std::size_t v = 0; v < 6; ++v) {
        std::set<int> distinct;
        int used = 0;
        double sum = 0;
        for (int k = 0; k < 4; ++k) {
            sum += weights[4 * v + k];
            if (weights[4 * v + k] > 0)
                distinct.insert(joints[4 * v + k]), ++used;
        }
        EXPECT_NEAR(sum, 1, 8e-7);  // the validator's limit for four weights
        EXPECT_EQ(static_cast<int>(distinct.size()), used);
    }
    expect_valid(folder / "out.glb");
    // Left as it is, the third vertex's sum of 0.5 is still repaired.
    opened.write(folder / "same.glb", opened.identity());
    expect_valid(folder / "same.glb");
    EXPECT_NE(opened.warnings.back().find("weights"), std::string::npos);
}

TEST(Output, DegenerateTrianglesAreWrittenAsTheyAre) {
    Folder folder;
    Draft draft;
    draft.one_mesh({{"POSITION", draft.positions({0, 0, 0, 1, 0, 0, 0, 1, 0, 2, 0, 0, 3, 0, 0, 4, 0, 0})}});
    Opened opened(draft.write(folder));
    ASSERT_EQ(opened.welded.surface.face_count(), 1);
    opened.write(folder / "out.glb", opened.lifted(0.5));
    const auto points = floats(folder / "out.glb", "POSITION");
    ASSERT_EQ(points.size(), 18u);
    EXPECT_EQ(points[9], 2.0f);
    EXPECT_EQ(points[11], 0.0f);
}

TEST(Output, QuantisedInputIsDecodedAndTheExtensionGoes) {
    Folder folder;
    Draft draft;
    const std::size_t position =
        draft.accessor<std::int16_t>({-32768, 0, 32767, 0, 32767, 0, 0, 0, 0, 32767, 0, 0}, 5122, "VEC3", 3, true);
    draft.json["accessors"][position]["count"] = 3;
    draft.json["accessors"][position]["min"] = {-32768, 0, 0};
    draft.json["accessors"][position]["max"] = {32767, 32767, 32767};
    draft.json["bufferViews"][0]["byteStride"] = 8;
    draft.one_mesh({{"POSITION", position}});
    draft.json["extensionsUsed"] = draft.json["extensionsRequired"] = {"KHR_mesh_quantization"};
    Opened opened(draft.write(folder));
    EXPECT_EQ(opened.asset.mesh().points[0], Point(-1, 0, 1));
    opened.write(folder / "same.glb", opened.identity());
    EXPECT_TRUE(json_of(folder / "same.glb").contains("extensionsRequired")) << "still in use";
    opened.write(folder / "out.glb", opened.lifted(0.1));
    EXPECT_FALSE(json_of(folder / "out.glb").contains("extensionsRequired"));
    EXPECT_FALSE(json_of(folder / "out.glb").contains("extensionsUsed"));
    expect_valid(folder / "same.glb");
    expect_valid(folder / "out.glb");
}

TEST(Output, SceneTravelsInExtras) {
    Folder folder;
    Draft draft = triangle();
    draft.json["meshes"][0]["extras"] = {{"artist", "someone"}};
    Opened opened(draft.write(folder));
    EXPECT_FALSE(opened.asset.embedded_scene());
    WriteOptions options;
    options.scene = {{"pvg", 1}, {"layers", nlohmann::json::array()}};
    opened.write(folder / "out.glb", opened.lifted(0.1), options);
    const Json json = json_of(folder / "out.glb");
    EXPECT_EQ(json["meshes"][0]["extras"]["artist"], "someone");
    EXPECT_TRUE(json["meshes"][0]["extras"]["pvg"].contains("version"));
    Opened again(folder / "out.glb");
    ASSERT_TRUE(again.asset.embedded_scene());
    EXPECT_EQ(*again.asset.embedded_scene(), options.scene);
}

TEST(Output, EverythingElseSurvivesByteForByte) {
    Folder folder;
    Draft draft = cube();
    const std::string png = "\x89PNG\r\n\x1a\nnot really, but ours to keep", jpg = "\xff\xd8\xff\xe0 neither";
    put(folder / "a picture.png", png);
    draft.json["images"] = {{{"uri", "a%20picture.png"}, {"extras", {{"k", 3}}}},
                            {{"uri", "data:image/jpeg;base64,/9j/4CBuZWl0aGVy"}}};
    draft.json["textures"] = {{{"source", 0}}, {{"source", 1}}};
    put(folder / "other.bin", "second buffer");
    draft.json["buffers"] = {{{"uri", "data.bin"}, {"byteLength", draft.bin.size()}, {"name", "first"}},
                             {{"uri", "other.bin"}, {"byteLength", 13}}};
    draft.json["bufferViews"].push_back(
        {{"buffer", 1}, {"byteOffset", 7}, {"byteLength", 6}, {"extensions", {{"ACME_view", {{"deep", {1, 2.5, "x"}}}}}}});
    draft.json["extensionsUsed"] = {"ACME_view", "ACME_node"};
    draft.json["nodes"][0]["extensions"] = {{"ACME_node", {{"big", 9007199254740993}}}};
    draft.json["extras"] = {{"z", 1}, {"a", {2, nullptr}}};
    draft.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.01}}}}};
    Opened opened(draft.write(folder));
    opened.write(folder / "out.glb", opened.lifted(0.1));
    const Json json = json_of(folder / "out.glb");
    const std::string bin = bin_of(folder / "out.glb");
    for (const char* key : {"asset", "nodes", "scenes", "scene", "textures", "cameras", "extras", "extensionsUsed"})
        EXPECT_EQ(json[key], draft.json[key]) << key;
    EXPECT_EQ(json["images"][0]["extras"]["k"], 3);
    const auto view_bytes = [&](std::size_t index) {
        const Json& view = json["bufferViews"][index];
        EXPECT_EQ(view["buffer"], 0);
        return bin.substr(view["byteOffset"].get<std::size_t>(), view["byteLength"].get<std::size_t>());
    };
    EXPECT_EQ(view_bytes(json["images"][0]["bufferView"].get<std::size_t>()), png);
    EXPECT_EQ(json["images"][0]["mimeType"], "image/png");
    EXPECT_EQ(view_bytes(json["images"][1]["bufferView"].get<std::size_t>()), jpg);
    EXPECT_EQ(bin.substr(0, draft.bin.size()), draft.bin);
    const std::size_t last = draft.json["bufferViews"].size() - 1;
    EXPECT_EQ(view_bytes(last), "buffer");
    EXPECT_EQ(json["bufferViews"][last]["extensions"], draft.json["bufferViews"][last]["extensions"]);
    EXPECT_EQ(json["buffers"].size(), 1u);
    EXPECT_EQ(json["buffers"][0]["name"], "first");
}

TEST(Output, NodesThatShareTheMeshAreNamed) {
    Folder folder;
    Draft draft = triangle();
    draft.json["nodes"] = {{{"mesh", 0}, {"name", "left"}}, {{"mesh", 0}, {"name", "right"}}};
    draft.json["scenes"][0]["nodes"] = {0, 1};
    Opened opened(draft.write(folder));
    opened.write(folder / "out.glb", opened.lifted(0.1));
    ASSERT_FALSE(opened.warnings.empty());
    EXPECT_NE(opened.warnings.back().find("\"left\", \"right\""), std::string::npos);
}

TEST(Output, ScenesKeepOnlyRoots) {
    Folder folder;
    Draft draft = triangle();
    draft.json["nodes"] = {{{"mesh", 0}}, {{"children", {0}}}, {{"name", "alone"}}};
    draft.json["scenes"][0]["nodes"] = {1, 0, 2};
    Opened opened(draft.write(folder));
    opened.write(folder / "out.glb", opened.identity());
    EXPECT_EQ(json_of(folder / "out.glb")["scenes"][0]["nodes"], Json({1, 2}));
    expect_valid(folder / "out.glb");
}

TEST(Output, NonUnitNormalsThatWouldStayAreRefused) {
    Folder folder;
    Draft draft = triangle();
    draft.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] =
        draft.accessor<float>({0, 0, 1, 0, 0, 0.5f, 0, 0, 1}, real, "VEC3", 3);
    Opened opened(draft.write(folder));
    DecoratedMesh mesh = opened.lifted(0.1);
    opened.write(folder / "out.glb", mesh);  // all replaced
    mesh.decorated[1] = mesh.color_decorated[1] = mesh.moved[1] = 0;
    try {
        opened.write(folder / "bad.glb", mesh);
        FAIL() << "a normal of length 0.5 was written";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::bad_input);
        EXPECT_NE(std::string(error.what()).find("vertex 1"), std::string::npos);
    }
    EXPECT_FALSE(std::filesystem::exists(folder / "bad.glb"));
}

TEST(Output, IndicesGrowWithTheVertices) {
    Folder folder;
    std::vector<float> points;
    for (int i = 0; i < 22000; ++i)
        for (float value :
             {0.0f, 0.0f, static_cast<float>(i), 1.0f, 0.0f, static_cast<float>(i), 0.0f, 1.0f, static_cast<float>(i)})
            points.push_back(value);
    Draft draft;
    draft.one_mesh({{"POSITION", draft.positions(points)}});
    Opened opened(draft.write(folder));
    opened.write(folder / "out.glb", opened.lifted(0.1));
    const Json json = json_of(folder / "out.glb");
    EXPECT_EQ(json["accessors"][json["meshes"][0]["primitives"][0]["indices"].get<std::size_t>()]["componentType"], 5125);
    expect_valid(folder / "out.glb");
}

}  // namespace
}  // namespace pvg::test
