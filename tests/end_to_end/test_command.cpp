// The command line as users' scripts rely on it: verbs, exit codes, messages, what goes where.
#include "end_to_end/command.h"

#include <cmath>

namespace pvg::test {
namespace {

using nlohmann::json;

class Command : public CommandTest {
protected:
    /// A plane of about a thousand vertices and a scene with one circle on it.
    json scene() const {
        return json::parse(R"({"pvg": 1, "mesh": {"file": "plane.glb"}, "layers": [{"name": "a", "on": "base", "primitives": [
            {"kind": "diffusion_curve", "id": "rim", "path": {"type": "circle", "center": [0, 0, 0], "radius": 0.2, "snap": "any"},
             "left": {"color": "#ff0000", "height": 0.02}}]}]})");
    }
    void make_plane() {
        const Outcome made = pvg("make plane -o plane.glb --vertices 1000");
        ASSERT_EQ(made.exit, 0) << made.err;
        ASSERT_EQ(made.out, "");
    }
    void write_scene(const json& document, const std::string& name = "s.pvg.json") const {
        write_all(folder / name, document.dump(2));
    }

    void expect_refused(const json& document, const std::string& pointer, const std::string& phrase) {
        write_scene(document);
        const Outcome outcome = pvg("decorate s.pvg.json -o out.glb");
        EXPECT_EQ(outcome.exit, 3) << outcome.err;
        EXPECT_NE(outcome.err.find("s.pvg.json"), std::string::npos) << outcome.err;
        EXPECT_NE(outcome.err.find(pointer), std::string::npos) << outcome.err;
        EXPECT_NE(outcome.err.find(phrase), std::string::npos) << outcome.err;
        EXPECT_FALSE(fs::exists(folder / "out.glb"));
        for (const auto& entry : fs::directory_iterator(folder)) EXPECT_NE(entry.path().extension(), ".pvg-tmp");
    }
};

TEST_F(Command, HelpAndVersion) {
    EXPECT_EQ(pvg("--help").exit, 0);
    for (const char* verb : {"decorate", "check", "make", "info", "devices"}) {
        const Outcome help = pvg(std::string(verb) + " --help");
        EXPECT_EQ(help.exit, 0);
        EXPECT_NE(help.out.find(verb), std::string::npos);
        EXPECT_NE(pvg("--help").out.find(verb), std::string::npos);
    }
    const Outcome version = pvg("--version");
    EXPECT_EQ(version.exit, 0);
    EXPECT_EQ(version.out, std::string(PVG_VERSION) + "\n");
}

TEST_F(Command, WrongUsageIsExitTwo) {
    for (const char* line : {"", "frobnicate", "decorate", "decorate s.pvg.json", "decorate s.pvg.json -o out.glb --no-such-flag",
                             "make", "make plane -o p.glb --vertices x", "make blob -o p.glb", "check s.pvg.json --tolerance 1,2",
                             "decorate s.pvg.json -o out.glb --device moon", "decorate s.pvg.json -o out.obj",
                             "decorate s.pvg.json -o out.glb --basis fem", "check s.pvg.json --basis"}) {
        make_plane();
        write_scene(scene());
        const Outcome outcome = pvg(line);
        EXPECT_EQ(outcome.exit, 2) << line << ": " << outcome.err;
        EXPECT_NE(outcome.err, "") << line;
        EXPECT_EQ(outcome.out, "") << line;
    }
}

TEST_F(Command, DecorateWritesQuietlyAndReports) {
    make_plane();
    write_scene(scene());
    const Outcome outcome = pvg("decorate s.pvg.json -o out.glb --device cpu --fields --report r.json -q");
    ASSERT_EQ(outcome.exit, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(outcome.err, "");
    const json report = json::parse(read_all(folder / "r.json"));
    EXPECT_EQ(report["pvg"], PVG_VERSION);
    EXPECT_EQ(report["device"]["type"], "cpu");
    EXPECT_GT(report["vertices"]["out"].get<int>(), report["vertices"]["in"].get<int>());
    EXPECT_GT(report["vertices"]["decorated"].get<int>(), 100);
    EXPECT_EQ(report["primitives"], 1);
    EXPECT_GT(report["knots"].get<int>(), 20);
    EXPECT_GT(report["table"]["entries_per_vertex"].get<double>(), 1);
    double sum = 0;
    for (const char* stage : {"read", "curves", "knots", "voronoi", "system", "basis", "upload", "evaluate", "write"}) {
        ASSERT_TRUE(report["stages"].contains(stage)) << stage;
        sum += report["stages"][stage].get<double>();
    }
    EXPECT_LE(sum, report["total"].get<double>() * 1.001);
    EXPECT_GT(report["peak_memory"].get<double>(), 1e6);
    EXPECT_TRUE(report["warnings"].is_array());
}

TEST_F(Command, SameBytesTwiceAndForAnyThreadCount) {
    make_plane();
    write_scene(scene());
    ASSERT_EQ(pvg("decorate s.pvg.json -o a.glb --device cpu --threads 1").exit, 0);
    ASSERT_EQ(pvg("decorate s.pvg.json -o b.glb --device cpu --threads 1").exit, 0);
    ASSERT_EQ(pvg("decorate s.pvg.json -o c.glb --device cpu --threads 3").exit, 0);
    EXPECT_EQ(read_all(folder / "a.glb"), read_all(folder / "b.glb"));
    EXPECT_EQ(read_all(folder / "a.glb"), read_all(folder / "c.glb"));
}

TEST_F(Command, SetChangesTheSceneBeforeItIsChecked) {
    make_plane();
    write_scene(scene());
    ASSERT_EQ(pvg("decorate s.pvg.json -o a.glb --device cpu").exit, 0);
    ASSERT_EQ(pvg("decorate s.pvg.json -o b.glb --device cpu --set rim.left.height=0.05").exit, 0);
    EXPECT_NE(read_all(folder / "a.glb"), read_all(folder / "b.glb"));
    EXPECT_EQ(pvg("decorate s.pvg.json -o c.glb --set rim.left.height=tall").exit, 3);
    EXPECT_EQ(pvg("decorate s.pvg.json -o c.glb --set nobody.left.height=1").exit, 2);
}

TEST_F(Command, BadScenesNameThePlace) {
    make_plane();
    json bad = scene();
    bad["layers"][0]["primitives"][0]["left"]["color"] = "redd";
    expect_refused(bad, "/layers/0/primitives/0/left/color", "\"redd\"");
    bad = scene();
    bad["layers"][0]["primitives"][0]["lefft"] = 1;
    expect_refused(bad, "/layers/0/primitives/0", "left");
    bad = scene();
    bad["layers"][0]["primitives"][0]["path"]["radius"] = -1;
    expect_refused(bad, "/layers/0/primitives/0/path/radius", "-1");
    bad = scene();
    bad["layers"][0]["primitives"][0]["path"]["radius"] = 0.9;
    expect_refused(bad, "/layers/0/primitives/0", "largest");
    bad = scene();
    bad["layers"][0]["primitives"][0]["path"]["center"] = {0, 0, 9};
    bad["layers"][0]["primitives"][0]["path"].erase("snap");
    expect_refused(bad, "/layers/0/primitives/0/path/center", "surface");
    bad = scene();
    bad["basis"]["kind"] = "greens";
    expect_refused(bad, "/basis/kind", "\"greens\"");
    bad = scene();
    bad["basis"]["normalize"] = 1;
    expect_refused(bad, "/basis/normalize", "true or false");
    bad = scene();
    bad.erase("pvg");
    expect_refused(bad, "", "pvg");
    bad = scene();
    bad["mesh"]["file"] = "nowhere.glb";
    write_scene(bad);
    const Outcome outcome = pvg("decorate s.pvg.json -o out.glb");
    EXPECT_EQ(outcome.exit, 3);
    EXPECT_NE(outcome.err.find("nowhere.glb"), std::string::npos);
    write_all(folder / "s.pvg.json", "{\"pvg\": 1,\n  oops}");
    EXPECT_EQ(pvg("decorate s.pvg.json -o out.glb").exit, 3);
    EXPECT_EQ(pvg("decorate missing.pvg.json -o out.glb").exit, 3);
}

TEST_F(Command, SourceWithoutDiffusionCurveNamesThePrimitive) {
    make_plane();
    json bad = scene();
    bad["layers"][0]["primitives"] = json::parse(
        R"([{"kind": "poisson_region", "id": "bump", "path": {"type": "circle", "center": [0, 0, 0], "radius": 0.1, "snap": "any"}, "rise": {"height": 0.1}}])");
    expect_refused(bad, "bump", "needs at least one diffusion curve");
}

TEST_F(Command, UnwritableOutputIsExitFiveAndLeavesTheOldFile) {
    make_plane();
    write_scene(scene());
    EXPECT_EQ(pvg("decorate s.pvg.json -o missing/out.glb --device cpu").exit, 5);
    fs::create_directories(folder / "out.glb");  // a folder cannot be replaced by a file
    EXPECT_EQ(pvg("decorate s.pvg.json -o out.glb --device cpu").exit, 5);
    EXPECT_TRUE(fs::is_directory(folder / "out.glb"));
    for (const auto& entry : fs::directory_iterator(folder)) EXPECT_NE(entry.path().extension(), ".pvg-tmp");
}

TEST_F(Command, WithoutAnyDeviceAutoTakesTheCpuAndVulkanIsExitFour) {
    make_plane();
    write_scene(scene());
    const std::string no_driver = "VK_ICD_FILENAMES=/nonexistent VK_DRIVER_FILES=/nonexistent";
    const Outcome automatic = pvg("decorate s.pvg.json -o a.glb", no_driver);
    EXPECT_EQ(automatic.exit, 0) << automatic.err;
    EXPECT_NE(automatic.err.find("CPU"), std::string::npos);
    ASSERT_EQ(pvg("decorate s.pvg.json -o b.glb --device cpu").exit, 0);
    EXPECT_EQ(read_all(folder / "a.glb"), read_all(folder / "b.glb"));
    EXPECT_EQ(pvg("decorate s.pvg.json -o c.glb --device vulkan", no_driver).exit, 4);
    EXPECT_EQ(pvg("decorate s.pvg.json -o c.glb --device 'vulkan:no such device'").exit, 4);
    EXPECT_FALSE(fs::exists(folder / "c.glb"));
    EXPECT_EQ(pvg("devices", no_driver).exit, 0);
    const json list = json::parse(pvg("devices --json", no_driver).out);
    EXPECT_TRUE(list["devices"].empty());
}

TEST_F(Command, CheckPrintsOneJsonDocumentAndFailsPastTheTolerance) {
    make_plane();
    write_scene(scene());
    const Outcome outcome = pvg("check s.pvg.json --json");
    const json result = json::parse(outcome.out);
    EXPECT_EQ(outcome.exit, result["ok"].get<bool>() ? 0 : 1);
    for (const char* channel : {"r", "g", "b", "a", "height"}) {
        for (const char* key : {"mean", "max", "h1"})
            EXPECT_TRUE(result["bases"]["local"][channel][key].is_number()) << channel << key;
        for (const char* key : {"mean", "max"}) EXPECT_TRUE(result["lambda"][channel][key].is_number());
    }
    EXPECT_EQ(pvg("check s.pvg.json --tolerance 100,100,100").exit, 0);
    json two = scene();
    two["layers"][0]["primitives"].push_back(json::parse(
        R"({"kind": "poisson_region", "path": {"type": "circle", "center": [0, 0, 0], "radius": 0.1, "snap": "any"}, "rise": {"height": 0.1}})"));
    write_scene(two);
    EXPECT_EQ(pvg("check s.pvg.json --tolerance 0,0,0").exit, 1);
}

TEST_F(Command, CheckComparesEveryBasis) {
    // Fine enough that not every vertex is a knot.
    ASSERT_EQ(pvg("make plane -o plane.glb --vertices 5000").exit, 0);
    json two = scene();
    two["layers"][0]["primitives"].push_back(json::parse(
        R"({"kind": "poisson_region", "path": {"type": "circle", "center": [0, 0, 0], "radius": 0.1, "snap": "any"}, "rise": {"height": 0.1}})"));
    write_scene(two);
    const json result = json::parse(pvg("check s.pvg.json --json --device cpu").out);
    EXPECT_EQ(result["basis"], "local");
    EXPECT_TRUE(result["left_out"].empty());
    for (const char* basis : {"local", "green", "green_raw", "exact"})
        for (const char* key : {"mean", "max", "h1"})
            EXPECT_TRUE(result["bases"][basis]["height"][key].is_number()) << basis << key;
    EXPECT_GT(result["bases"]["green_raw"]["height"]["h1"].get<double>(), result["bases"]["green"]["height"]["h1"].get<double>());
    EXPECT_GT(result["bases"]["green"]["height"]["h1"].get<double>(), result["bases"]["exact"]["height"]["h1"].get<double>());
    // The local basis improves the cell system's coefficients.
    EXPECT_LT(result["lambda"]["height"]["mean"].get<double>(), result["cell_lambda"]["height"]["mean"].get<double>());

    // Only the scene's own basis is judged; the errors do not depend on which one that is.
    const double between =
        (result["bases"]["exact"]["height"]["h1"].get<double>() + result["bases"]["green"]["height"]["h1"].get<double>()) / 2;
    const std::string tolerance = " --tolerance 100,100," + std::to_string(between);
    EXPECT_EQ(pvg("check s.pvg.json" + tolerance).exit, 0);
    EXPECT_EQ(pvg("check s.pvg.json --basis exact" + tolerance).exit, 0);
    EXPECT_EQ(pvg("check s.pvg.json --basis green" + tolerance).exit, 1);
    for (const char* basis : {"green", "exact"}) {
        const json other = json::parse(pvg("check s.pvg.json --json --basis " + std::string(basis)).out);
        EXPECT_EQ(other["basis"], basis);
        EXPECT_EQ(other["bases"], result["bases"]);
        EXPECT_EQ(other["lambda"], other["cell_lambda"]);
        if (!other["gpu_cpu"].is_null()) {
            EXPECT_TRUE(other["gpu_cpu"]["bit_identical"].get<bool>());
        }
    }
    two["basis"] = {{"kind", "green"}, {"normalize", false}};
    write_scene(two);
    EXPECT_EQ(json::parse(pvg("check s.pvg.json --json --device cpu").out)["basis"], "green_raw");
}

TEST_F(Command, CheckSaysWhatItLeavesOut) {
    make_plane();
    json dense = scene();
    dense["mesh"]["subdivide"] = 2;
    dense["knots"] = {{"spacing", 0.003}};
    write_scene(dense);
    const json quick = json::parse(pvg("check s.pvg.json --json --device cpu").out);
    ASSERT_FALSE(quick["left_out"].empty());
    EXPECT_EQ(quick["left_out"][0]["basis"], "green");
    EXPECT_NE(quick["left_out"][0]["reason"].get<std::string>().find("--all-bases"), std::string::npos);
    EXPECT_FALSE(quick["bases"].contains("green"));
    EXPECT_TRUE(quick["bases"].contains("exact"));
    EXPECT_NE(pvg("check s.pvg.json --device cpu").out.find("--all-bases"), std::string::npos);
    const json all = json::parse(pvg("check s.pvg.json --json --device cpu --all-bases").out);
    EXPECT_TRUE(all["left_out"].empty());
    EXPECT_TRUE(all["bases"].contains("green") && all["bases"].contains("green_raw"));
}

TEST_F(Command, DecorateTakesABasis) {
    make_plane();
    write_scene(scene());
    for (const char* basis : {"local", "green", "exact"}) {
        const std::string name = basis;
        ASSERT_EQ(pvg("decorate s.pvg.json -o " + name + ".glb --device cpu --report r.json --basis " + name).exit, 0);
        const json report = json::parse(read_all(folder / "r.json"));
        if (name == "exact") {
            EXPECT_EQ(report["table"]["entries_per_vertex"], 4);
        }
        // The scene that travels in the output asks for what was made.
        EXPECT_NE(read_all(folder / (name + ".glb")).find("\"kind\":\"" + name + "\""), std::string::npos) << name;
    }
    ASSERT_EQ(pvg("decorate s.pvg.json -o b.glb --device cpu --threads 3 --basis green").exit, 0);
    EXPECT_EQ(read_all(folder / "green.glb"), read_all(folder / "b.glb"));
    EXPECT_NE(read_all(folder / "green.glb"), read_all(folder / "local.glb"));
}

TEST_F(Command, InfoAndDevices) {
    make_plane();
    write_scene(scene());
    const json mesh = json::parse(pvg("info plane.glb --json").out);
    EXPECT_EQ(mesh["components"], 1);
    EXPECT_EQ(mesh["euler_characteristic"], 1);
    const json described = json::parse(pvg("info s.pvg.json --json").out);
    EXPECT_EQ(described["primitives"]["diffusion_curve"], 1);
    EXPECT_EQ(pvg("info nothing.glb").exit, 3);
    EXPECT_EQ(pvg("devices").exit, 0);
}

TEST_F(Command, WallsCloseTheCliffs) {
    // A circle with two heights on a sphere: cap and rest stand apart, joined by walls. No border, one piece, a sphere still.
    ASSERT_EQ(pvg("make sphere -o sphere.glb --vertices 3000").exit, 0);
    json document = scene();
    document["mesh"]["file"] = "sphere.glb";
    json& circle = document["layers"][0]["primitives"][0];
    circle["path"] = {{"type", "circle"}, {"center", {0, 0, 1}}, {"radius", 0.15}, {"snap", "any"}};
    circle["left"] = {{"height", 0.02}};
    circle["right"] = {{"height", -0.01}};
    write_scene(document);
    const auto topology = [&](const std::string& flags) {
        const Outcome decorated = pvg("decorate s.pvg.json -o out.glb --device cpu" + flags);
        EXPECT_EQ(decorated.exit, 0) << decorated.err;
        return json::parse(pvg("info out.glb --json").out);
    };
    const json whole = json::parse(pvg("info sphere.glb --json").out), walled = topology(""), flat = topology(" --no-displace");
    for (const json* info : {&whole, &walled, &flat}) {
        EXPECT_EQ((*info)["welded"]["border_edges"], 0);
        EXPECT_EQ((*info)["welded"]["non_manifold_edges"], 0);
        EXPECT_EQ((*info)["components"], 1);
        EXPECT_EQ((*info)["euler_characteristic"], 2);
    }
    // Cap and rest are parts of spheres of other radii, the wall the piece of a cone between them (without it: 0.946).
    const double diagonal = 2 * std::sqrt(3.0), angle = 0.15 * diagonal, up = 1 + 0.02 * diagonal, down = 1 - 0.01 * diagonal;
    const double cap = (1 - std::cos(angle)) / 2;
    const double expected = cap * up * up + (1 - cap) * down * down + std::sin(angle) * (up * up - down * down) / 4;
    EXPECT_NEAR(walled["area"].get<double>() / whole["area"].get<double>(), expected, 0.005);
    EXPECT_NEAR(flat["area"].get<double>() / whole["area"].get<double>(), 1, 1e-5);
}

TEST_F(Command, MakeGivesEveryShape) {
    const std::pair<const char*, int> shapes[] = {{"cuboid", 2}, {"sphere", 2}, {"plane", 1}, {"torus", 0}};
    for (const auto& [shape, euler] : shapes) {
        ASSERT_EQ(pvg(std::string("make ") + shape + " -o m.glb --vertices 2000").exit, 0) << shape;
        const json mesh = json::parse(pvg("info m.glb --json").out);
        EXPECT_EQ(mesh["euler_characteristic"], euler) << shape;
        EXPECT_NEAR(mesh["welded"]["vertices"].get<int>(), 2000, 200) << shape;
        EXPECT_EQ(mesh["welded"]["non_manifold_edges"], 0) << shape;
    }
    for (const char* shape : {"vase", "stele"}) {
        ASSERT_EQ(pvg(std::string("make ") + shape + " -o m.glb --vertices 2000").exit, 0) << shape;
        const json mesh = json::parse(pvg("info m.glb --json").out);
        EXPECT_EQ(mesh["components"], 1) << shape;
        EXPECT_EQ(mesh["welded"]["non_manifold_edges"], 0) << shape;
    }
}

}  // namespace
}  // namespace pvg::test
