// Colours through the command: the space they are diffused in, straight alpha, and what COLOR_0 gets.
#include <array>
#include <cmath>

#include "end_to_end/command.h"
#include "gltf/fixtures.h"
#include "scene/color.h"

namespace pvg::test {
namespace {

using nlohmann::json;

class Colors : public CommandTest {
protected:
    /// A square between two lines, x = -0.3 with `low` and x = 0.3 with `high`, from border to border: in between every channel
    /// is linear in x, exactly.
    json scene(const json& low, const json& high, const std::string& space) const {
        const auto line = [](double x) { return json{{"type", "polyline"}, {"points", {{x, -0.5, 0}, {x, 0.5, 0}}}}; };
        return {{"pvg", 1},
                {"mesh", {{"file", "plane.glb"}}},
                {"length_unit", "mesh"},
                {"color_space", space},
                {"layers",
                 {{{"name", "a"},
                   {"primitives",
                    {{{"kind", "diffusion_curve"}, {"path", line(-0.3)}, {"both", {{"color", low}}}},
                     {{"kind", "diffusion_curve"}, {"path", line(0.3)}, {"both", {{"color", high}}}}}}}}}};
    }

    struct Vertex {
        double x;
        std::array<double, 4> field, color;  // _PVG_COLOR, COLOR_0
    };
    std::vector<Vertex> decorated(const json& document) {
        EXPECT_EQ(pvg("make plane -o plane.glb --vertices 900").exit, 0);
        write_all(folder / "s.pvg.json", document.dump());
        const Outcome outcome = pvg("decorate s.pvg.json -o out.glb --fields --device cpu");
        EXPECT_EQ(outcome.exit, 0) << outcome.err;
        const fs::path file = folder / "out.glb";
        const json glb = json_of(file);
        const json& attributes = glb["meshes"][0]["primitives"][0]["attributes"];
        const auto number = [&](const char* name) { return attributes.at(name).get<std::size_t>(); };
        EXPECT_EQ(glb["accessors"][number("COLOR_0")]["type"], "VEC4");
        const std::vector<float> position = values_of<float>(file, number("POSITION")),
                                 field = values_of<float>(file, number("_PVG_COLOR"));
        const bool floats = glb["accessors"][number("COLOR_0")]["componentType"] == 5126;
        const std::vector<float> color = floats ? values_of<float>(file, number("COLOR_0")) : std::vector<float>();
        EXPECT_TRUE(floats) << "--fields asks for floats";
        std::vector<Vertex> vertices;
        for (std::size_t v = 0; 3 * v < position.size(); ++v) {
            Vertex vertex{position[3 * v], {}, {}};
            for (std::size_t c = 0; c < 4; ++c) {
                vertex.field[c] = field.at(4 * v + c);
                vertex.color[c] = color.at(4 * v + c);
            }
            vertices.push_back(vertex);
        }
        return vertices;
    }
};

TEST_F(Colors, AreLinearInTheSpaceOfDiffusion) {
    const Color red(1, 0.1, 0, 1), teal(0, 0.4, 0.7, 1);
    const std::pair<const char*, ColorSpace> spaces[] = {
        {"linear", ColorSpace::linear}, {"srgb", ColorSpace::srgb}, {"oklab", ColorSpace::oklab}};
    std::vector<double> middles;
    for (const auto& [name, space] : spaces) {
        int between = 0;
        double middle = 0, nearest = 1;
        for (const Vertex& v : decorated(scene({1, 0.1, 0}, {0, 0.4, 0.7}, name))) {
            const double t = std::clamp((v.x + 0.3) / 0.6, 0.0, 1.0);
            between += t > 0.01 && t < 0.99;
            const Color expected =
                from_diffusion_space((1 - t) * to_diffusion_space(red, space) + t * to_diffusion_space(teal, space), space);
            for (int c = 0; c < 4; ++c) {
                EXPECT_NEAR(v.field[c], expected[c], 1e-5) << name << " at " << v.x;
                EXPECT_NEAR(v.color[c], std::clamp(expected[c], 0.0, 1.0), 1e-5) << name << " at " << v.x;
            }
            if (std::abs(v.x) < nearest) {
                nearest = std::abs(v.x);
                middle = v.field[0];
            }
        }
        EXPECT_GT(between, 300) << name;
        middles.push_back(middle);
    }
    // The spaces differ where it matters: half of linear red is 0.5, half of sRGB's 255 is 0.21.
    EXPECT_GT(middles[0] - middles[1], 0.2);
    EXPECT_GT(std::abs(middles[2] - middles[1]), 0.02);
}

TEST_F(Colors, AlphaIsStraightAndCompositedOverTheInput) {
    for (const char* space : {"linear", "srgb", "oklab"}) {
        int between = 0;
        for (const Vertex& v : decorated(scene({1, 0, 0, 1}, {1, 0, 0, 0}, space))) {
            const double alpha = 1 - std::clamp((v.x + 0.3) / 0.6, 0.0, 1.0);
            between += alpha > 0.01 && alpha < 0.99;
            EXPECT_NEAR(v.field[0], 1, 1e-5);
            EXPECT_NEAR(v.field[1], 0, 1e-5);
            EXPECT_NEAR(v.field[3], alpha, 1e-5);
            // Over white (the input has no colours), whose alpha stays.
            EXPECT_NEAR(v.color[0], 1, 1e-5);
            EXPECT_NEAR(v.color[1], 1 - alpha, 1e-5);
            EXPECT_NEAR(v.color[3], 1, 1e-6);
        }
        EXPECT_GT(between, 300);
    }
}

TEST_F(Colors, OfALaterLayerBlendInLinearLight) {
    // Half-clear green over red, by the W3C's general formula; each layer is a problem of its own.
    json document = scene({1, 0, 0}, {1, 0, 0}, "oklab");
    json second = document["layers"][0];
    second["name"] = "b";
    for (json& primitive : second["primitives"]) primitive["both"]["color"] = {0, 1, 0, 0.5};
    document["layers"].push_back(second);
    for (const Vertex& v : decorated(document)) {
        EXPECT_NEAR(v.color[0], 0.5, 1e-5);
        EXPECT_NEAR(v.color[1], 0.5, 1e-5);
        EXPECT_NEAR(v.color[2], 0, 1e-5);
    }
    document["layers"][1]["blend"] = "multiply";
    for (const Vertex& v : decorated(document)) {
        EXPECT_NEAR(v.color[0], 0.5, 1e-5);
        EXPECT_NEAR(v.color[1], 0, 1e-5);
    }
}

}  // namespace
}  // namespace pvg::test
