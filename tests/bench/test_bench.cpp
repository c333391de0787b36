// pvg bench: the document that scripts read, and that what is timed is verified.
#include "end_to_end/command.h"

namespace pvg::test {
namespace {

using nlohmann::json;

class Bench : public CommandTest {
protected:
    void SetUp() override {
        CommandTest::SetUp();
        ASSERT_EQ(pvg("make sphere -o sphere.glb --vertices 3000").exit, 0);
        write_all(folder / "s.pvg.json", R"({"pvg": 1, "mesh": {"file": "sphere.glb"}, "layers": [{"name": "a", "primitives": [
            {"kind": "diffusion_curve", "path": {"type": "circle", "center": [0, 0, 1], "radius": 0.2, "snap": "any"},
             "left": {"color": [1, 0, 0], "height": 0.02}, "right": {"color": [0, 0, 1], "height": 0}},
            {"kind": "poisson_curve", "path": {"type": "circle", "center": [1, 0, 0], "radius": 0.1, "snap": "any"},
             "jump": {"color": [0, 0.2, 0], "height": 0.01}}]}]})");
    }
};

TEST_F(Bench, JsonHasWhatScriptsRead) {
    const Outcome outcome = pvg("bench s.pvg.json --json --rounds 3");
    ASSERT_EQ(outcome.exit, 0) << outcome.err;
    const json result = json::parse(outcome.out);
    for (const char* key : {"vertices", "knots", "channels", "threads"}) EXPECT_GT(result.at(key).get<int>(), 0) << key;
    EXPECT_EQ(result.at("channels"), 5);
    EXPECT_TRUE(result.contains("device"));
    EXPECT_EQ(result.at("verified"), true);
    EXPECT_GT(result.at("recolour").at("columns").get<int>(), 0);
    EXPECT_LT(result.at("recolour").at("error_percent").get<double>(), 0.39);
    const std::vector<std::pair<std::string, std::vector<std::string>>> times = {
        {"stages", {"curves", "knots", "voronoi", "system", "basis", "total"}},
        {"recolour", {"solve", "evaluate_cpu", "total_cpu"}},
        {"edit", {"seconds", "cells"}},
        {"rivals", {"cholmod_solve", "eigen_solve", "fem_refactor", "cgal_geodesics", "triad_bytes_per_second"}},
        {"ratios", {"recolour_cpu", "geodesics", "evaluate_of_triad", "build_of_edit"}}};
    for (const auto& [group, keys] : times)
        for (const std::string& key : keys) EXPECT_GT(result.at(group).at(key).get<double>(), 0) << group << "." << key;
}

TEST_F(Bench, BadInputHasTheCommandsExitCodes) {
    EXPECT_EQ(pvg("bench nowhere.pvg.json").exit, 3);
    EXPECT_EQ(pvg("bench").exit, 2);
    EXPECT_EQ(pvg("bench s.pvg.json --moon").exit, 2);
    EXPECT_EQ(pvg("bench --help").exit, 0);
    write_all(folder / "g.pvg.json",
              R"({"pvg": 1, "mesh": {"file": "sphere.glb"}, "basis": {"kind": "green"}, "layers": [{"name": "a",
        "primitives": []}]})");
    const Outcome other = pvg("bench g.pvg.json");
    EXPECT_EQ(other.exit, 3);
    EXPECT_NE(other.err.find("/basis/kind"), std::string::npos) << other.err;
}

}  // namespace
}  // namespace pvg::test
