// The project's own scenes through the command: valid glTF, right by finite elements, the same on GPU and CPU.
#include "end_to_end/command.h"

namespace pvg::test {
namespace {

using nlohmann::json;

const char* environment(const char* name) {
    const char* value = std::getenv(name);
    return value && *value ? value : nullptr;
}

/// The method's target for every scene: mean, max, H1 in % against finite elements, entries a vertex.
constexpr const char* target = " --tolerance 0.05,0.39,2";
constexpr double most_entries = 24;

class Scenes : public CommandTest, public testing::WithParamInterface<const char*> {
protected:
    /// The scene beside its mesh in the folder; false where what makes the mesh is not at hand.
    bool prepare(std::string& reason) {
        const std::string name = GetParam();
        const fs::path scenes = fs::path(PVG_SOURCE_DIR) / "scenes";
        const fs::path file = name + ".pvg.json";
        fs::copy_file(scenes / file, folder / file, fs::copy_options::overwrite_existing);
        const json document = json::parse(read_all(folder / file));
        const fs::path mesh = document["mesh"]["file"].get<std::string>();
        return name == "bunny" ? make_bunny(mesh, reason) : make(name, mesh);
    }
    bool make_bunny(const fs::path& mesh, std::string& reason) {
        const char* modules = environment("PVG_NODE_MODULES");
        if (!modules) {
            reason = "PVG_NODE_MODULES is not set: no bunny";
            return false;
        }
        return node("bunny_glb.mjs", quoted(modules) + " " + quoted((folder / mesh).string()));
    }
    bool node(const std::string& script, const std::string& arguments) {
        const fs::path file = fs::path(PVG_SOURCE_DIR) / "scenes" / script;
        const int status = std::system(("node " + quoted(file.string()) + " " + arguments + " >/dev/null").c_str());
        EXPECT_EQ(status, 0) << script << " " << arguments;
        return status == 0;
    }
    bool make(const std::string& name, const fs::path& mesh) {
        const Outcome made =
            pvg("make " + std::string(name == "two_regions" ? "plane" : "cuboid") + " --vertices 40000 -o " + mesh.string());
        EXPECT_EQ(made.exit, 0) << made.err;
        return made.exit == 0;
    }
};

TEST_P(Scenes, GpuAgreesWithCpuAndBothWithFiniteElements) {
    std::string reason;
    if (!prepare(reason))
        GTEST_SKIP() << reason;
    const Outcome outcome = pvg("check " + std::string(GetParam()) + ".pvg.json --json" + target);
    const json result = json::parse(outcome.out);
    std::printf("%s\n", result.dump().c_str());
    EXPECT_EQ(outcome.exit, 0) << outcome.err;
    if (result["gpu_cpu"].is_null())
        GTEST_SKIP() << "no Vulkan device";
    EXPECT_TRUE(result["gpu_cpu"]["bit_identical"].get<bool>());
}

TEST_P(Scenes, ThePapersExactSumAgreesWithTheLocalBasis) {
    std::string reason;
    if (!prepare(reason))
        GTEST_SKIP() << reason;
    const json result = json::parse(pvg("check " + std::string(GetParam()) + ".pvg.json --json --basis exact").out);
    for (const auto& [channel, error] : result["bases"]["exact"].items()) {
        const json& local = result["bases"]["local"][channel];
        // Both are this far from finite elements, so at most the sum from each other. What is left of the exact sum is the cell
        // system's: its fluxes. Largest errors stand where its lambda is worst, beside border edges that face obtuse angles.
        EXPECT_LT(error["mean"].get<double>() + local["mean"].get<double>(), 0.1) << channel;
        EXPECT_LT(error["max"].get<double>(), 1 + 10 * result["cell_lambda"][channel]["max"].get<double>()) << channel;
    }
    if (result["gpu_cpu"].is_null())
        GTEST_SKIP() << "no Vulkan device";
    EXPECT_TRUE(result["gpu_cpu"]["bit_identical"].get<bool>());
}

TEST_P(Scenes, OutputIsValidGltf) {
    std::string reason;
    if (!prepare(reason))
        GTEST_SKIP() << reason;
    const std::string name = GetParam();
    const Outcome outcome = pvg("decorate " + name + ".pvg.json -o out.glb --fields --report r.json --device cpu");
    ASSERT_EQ(outcome.exit, 0) << outcome.err;
    const json report = json::parse(read_all(folder / "r.json"));
    std::printf("%s: %.1f entries a vertex, %d knots\n", name.c_str(), report["table"]["entries_per_vertex"].get<double>(),
                report["knots"].get<int>());
    EXPECT_LE(report["table"]["entries_per_vertex"].get<double>(), most_entries);
    if (!environment("PVG_NODE_MODULES"))
        GTEST_SKIP() << "PVG_NODE_MODULES is not set: no validator";
    const std::string line =
        "node " + quoted(std::string(PVG_SOURCE_DIR) + "/tests/gltf/validate.mjs") + " " + quoted((folder / "out.glb").string());
    EXPECT_EQ(std::system(line.c_str()), 0);
}

/// The badge of the bunny moved over its thigh: accuracy may not hang on where a curve happens to meet the mesh.
class Placements : public Scenes {};

TEST_P(Placements, AreAsAccurate) {
    std::string reason;
    if (!make_bunny("bunny.glb", reason))
        GTEST_SKIP() << reason;
    ASSERT_TRUE(node("make_bunny_logo.mjs", quoted(environment("PVG_NODE_MODULES")) + " " +
                                                quoted((folder / "moved.pvg.json").string()) + " " + GetParam()));
    for (const char* max_edge : {"0.01", "0.014"}) {
        json scene = json::parse(read_all(folder / "moved.pvg.json"));
        scene["mesh"]["max_edge"] = json::parse(max_edge);
        write_all(folder / "moved.pvg.json", scene.dump());
        const Outcome outcome = pvg(std::string("check moved.pvg.json --device cpu --json") + target);
        EXPECT_EQ(outcome.exit, 0) << "max_edge " << max_edge << ": " << outcome.out << outcome.err;
    }
}

INSTANTIATE_TEST_SUITE_P(Bunny, Placements,
                         testing::Values("-0.05 0.19 0.165", "0.06 0.19 0.165", "0.075 0.19 0.165", "0.085 0.19 0.17",
                                         "0.1 0.18 0.165"),
                         [](const auto& placement) { return std::to_string(placement.index); });

INSTANTIATE_TEST_SUITE_P(All, Scenes, testing::Values("box", "flag", "two_regions", "bunny"),
                         [](const auto& scene) { return std::string(scene.param); });

}  // namespace
}  // namespace pvg::test
