// pvg-bench SCENE: what `pvg bench` runs. Stages, recolouring, a shape edit and the rivals on the same mesh, in one run, verified
// before they are timed. A program of its own, because two rivals (CHOLMOD's supernodal solver, CGAL) are under the GPL.
#include <sys/resource.h>

#include <cmath>
#include <cstdio>
#include <numeric>
#include <random>
#include <thread>

#include <CLI/CLI.hpp>
#include <Eigen/SparseCholesky>
#include <nlohmann/json.hpp>

#include "cpu_reference/cpu_evaluator.h"
#include "geodesic/geodesic.h"
#include "gltf/asset.h"
#include "measure.h"
#include "pvg/scene_document.h"
#include "pvg/vulkan.h"
#include "rivals.h"
#include "solve/build.h"
#include "solve/responses.h"

namespace pvg::bench {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
    std::filesystem::path scene;
    int threads = 0;
    int rounds = 15;
    bool json = false;
    bool quiet = false;
    bool geodesics = true;
    bool edit = true;
};

struct Bench {
    const Options& options;
    Scene scene;
    Build build;
    double total = 0;
    int largest = 0;  // the domain with the most vertices: what is recoloured
    bool verified = true;
    std::vector<std::string> failures;

    const Domain& domain() const { return build.arrangement.domains[largest]; }
    void expect(bool holds, const std::string& what) {
        if (holds)
            return;
        verified = false;
        failures.push_back(what);
    }
};

void say(const Bench& bench, const char* what) {
    if (!bench.options.quiet)
        std::fprintf(stderr, "%s\n", what);
}

/// The largest domain's field alone: nothing to displace.
Program field_only(const Bench& bench) {
    Program program;
    program.fields.push_back(bench.build.program.fields[bench.largest]);
    program.height_first = {0};
    program.corner_first = {0};
    return program;
}

/// Values by vertex of the domain, V x C.
Eigen::MatrixXd by_vertex(const Table& table, const std::vector<float>& values) {
    Eigen::MatrixXd u(table.row_count, table.channels);
    for (std::uint32_t row = 0; row < table.row_count; ++row)
        for (std::uint32_t c = 0; c < table.channels; ++c)
            u(table.row_vertex[row], c) = values[static_cast<std::size_t>(row) * table.channels + c];
    return u;
}

/// Every stop gets a new value of the size it has.
std::vector<Control> other_controls(const Domain& domain, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<Control> controls = domain.controls;
    for (Control& control : controls)
        for (Eigen::Index s = 0; s < control.value.rows(); ++s)
            for (Eigen::Index c = 0; c < control.value.cols(); ++c)
                control.value(s, c) *= 0.5 + static_cast<double>(random()) / 4294967296.0;
    return controls;
}

/// Recolouring by responses against a back-substitution: the same new values, the same mesh, the same threads.
void recolour(Bench& bench, Json& result) {
    const SolvedDomain& solved = bench.build.domains[bench.largest];
    Responses responses(bench.domain(), solved.knots, solved.system, solved.matrix, bench.build.program.fields[bench.largest].table,
                        solved.unbounded);
    say(bench, "responses");
    int columns = 0;
    const double prepare = seconds_of([&] { columns = responses.prepare_all(); });

    say(bench, "rivals: factorisation");
    Domain other = bench.domain();
    other.controls = other_controls(other, 1);
    apply_controls(other);
    const LinearSystem system = linear_system(other, energy_form(other));
    Cholmod cholmod(system.A);
    const double refactor = seconds_of([&] { cholmod.refactor(); });
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> eigen(system.A);

    // The same field first: what is timed is right.
    Program program = field_only(bench);
    Evaluation evaluation;
    program.fields[0].coefficients = responses.coefficients(other.controls);
    evaluate_on_cpu(program, evaluation, bench.options.threads);
    cholmod.solve(system.b);
    const Eigen::MatrixXd truth = system.P * cholmod.solution() + system.g;
    const Eigen::MatrixXd ours = by_vertex(program.fields[0].table, evaluation.values[0]);
    double worst = 0;
    for (Eigen::Index c = 0; c < truth.cols(); ++c) {
        const double range = truth.col(c).maxCoeff() - truth.col(c).minCoeff();
        if (range > 1e-6 * (truth.col(c).cwiseAbs().maxCoeff() + 1e-300))
            worst = std::max(worst, (ours.col(c) - truth.col(c)).cwiseAbs().maxCoeff() / range);
    }
    bench.expect(worst <= 0.01, "the recoloured field is " + std::to_string(100 * worst) + " % off the direct solution");
    const Eigen::MatrixXd by_eigen = eigen.solve(system.b);
    bench.expect((by_eigen - cholmod.solution()).cwiseAbs().maxCoeff() <= 1e-6 * (1 + by_eigen.cwiseAbs().maxCoeff()),
                 "Eigen and CHOLMOD disagree");

    say(bench, "recolouring");
    std::vector<std::vector<Control>> palettes;
    for (unsigned k = 0; k < 4; ++k) palettes.push_back(other_controls(bench.domain(), 2 + k));
    std::size_t palette = 0;
    Eigen::MatrixXd by_simplicial;
    const std::vector<double> seconds =
        medians_in_turn(bench.options.rounds,
                        {[&] { program.fields[0].coefficients = responses.coefficients(palettes[++palette % palettes.size()]); },
                         [&] { evaluate_on_cpu(program, evaluation, bench.options.threads); }, [&] { cholmod.solve(system.b); },
                         [&] { by_simplicial = eigen.solve(system.b); }});

    Json vulkan = nullptr, device = nullptr;
    Result<VulkanEvaluator> evaluator = VulkanEvaluator::create({});
    if (evaluator) {
        say(bench, "device");
        VulkanEvaluator& gpu = evaluator.value();
        device = gpu.device().name;
        if (const Result<bool> loaded = gpu.load(program); !loaded)
            throw Error(loaded.error());
        const Evaluation seen = gpu.evaluate().value();
        bench.expect(seen.values == evaluation.values, std::string(device) + " and the CPU differ");
        vulkan = medians_in_turn(bench.options.rounds, {[&] {
                                     const Result<bool> set = gpu.set_coefficients(0, program.fields[0].coefficients);
                                     if (!set || !gpu.evaluate())
                                         throw Error(ErrorKind::device, "the device failed");
                                 }})[0];
    }
    say(bench, "memory");
    const int threads = static_cast<int>(result["threads"]);
    const double triad = triad_bytes_per_second(threads);
    const Table& table = program.fields[0].table;
    const double streamed = static_cast<double>(table.bytes()) + 4.0 * table.row_count * table.channels;

    result["device"] = device;
    result["recolour"] = {{"columns", columns},
                          {"prepare", prepare},
                          {"solve", seconds[0]},
                          {"evaluate_cpu", seconds[1]},
                          {"evaluate_vulkan", vulkan},
                          {"total_cpu", seconds[0] + seconds[1]},
                          {"total_vulkan", vulkan.is_null() ? Json(nullptr) : Json(seconds[0] + vulkan.get<double>())},
                          {"error_percent", 100 * worst}};
    result["rivals"] = {{"blas", Cholmod::blas()},  {"cholmod_solve", seconds[2]},     {"eigen_solve", seconds[3]},
                        {"fem_refactor", refactor}, {"fem_unknowns", system.A.rows()}, {"triad_bytes_per_second", triad}};
    result["ratios"] = {
        {"recolour_cpu", seconds[2] / (seconds[0] + seconds[1])},
        {"recolour_vulkan", vulkan.is_null() ? Json(nullptr) : Json(seconds[2] / (seconds[0] + vulkan.get<double>()))},
        {"evaluate_of_triad", streamed / seconds[1] / triad},
        {"vulkan_of_cpu", vulkan.is_null() ? Json(nullptr) : Json(vulkan.get<double>() / seconds[1])}};
}

/// Exact distances from many sources: ours with the log map, CGAL's without one (it has none).
void geodesics(Bench& bench, Json& result) {
    const Surface& surface = bench.domain().surface;
    std::vector<int> vertices(surface.vertex_count());
    std::iota(vertices.begin(), vertices.end(), 0);
    std::shuffle(vertices.begin(), vertices.end(), std::mt19937(1));
    vertices.resize(std::max<std::size_t>(1, vertices.size() / 20));
    std::vector<GeodesicSource> sources;
    for (int v : vertices) sources.push_back({at_vertex(surface, v), 0});
    say(bench, "geodesics");
    GeodesicField ours;
    std::vector<double> theirs;
    const std::vector<double> seconds = medians_in_turn(
        1, {[&] { ours = geodesic_distances(surface, sources); }, [&] { theirs = cgal_distances(surface, vertices); }});
    double worst = 0, most = 0;
    for (std::size_t v = 0; v < theirs.size(); ++v)
        if (theirs[v] >= 0) {
            worst = std::max(worst, std::abs(ours.distance[v] - theirs[v]));
            most = std::max(most, theirs[v]);
        }
    bench.expect(worst <= 1e-6 * most, "our geodesics and CGAL's differ by " + std::to_string(worst));
    result["geodesics"] = {{"sources", vertices.size()}, {"seconds", seconds[0]}};
    result["rivals"]["cgal_geodesics"] = seconds[1];
    result["ratios"]["geodesics"] = seconds[1] / seconds[0];
}

/// One value set through the document, device included: from the call to the fence. Nothing where primitive 0 has no colour on
/// its left side.
void latency(Bench& bench, SceneDocument& document, Json& result) {
    const std::string primitive = "/layers/0/primitives/0";
    if (!document.prepare() || !document.set_color(primitive, Part::left, 0, {0.5, 0.5, 0.5, 1}))
        return;
    Result<VulkanEvaluator> evaluator = VulkanEvaluator::create({});
    if (evaluator && !evaluator.value().load(document.program()))
        throw Error(ErrorKind::device, "the device failed");
    say(bench, "latency");
    double shade = 0;
    const auto set = [&] {
        shade = shade < 0.9 ? shade + 0.01 : 0;
        const Result<Change> change = document.set_color(primitive, Part::left, 0, {shade, 0.5, 1 - shade, 1});
        if (!change)
            throw Error(change.error());
        return change.value().fields;
    };
    const std::vector<double> seconds = medians_in_turn(
        bench.options.rounds, {[&] { set(); },
                               [&] {
                                   for (std::uint32_t f : set()) {
                                       const std::vector<float>& values = document.program().fields[f].coefficients;
                                       if (evaluator && !evaluator.value().set_coefficients(f, values))
                                           throw Error(ErrorKind::device, "the device failed");
                                   }
                                   if (evaluator && !evaluator.value().evaluate())
                                       throw Error(ErrorKind::device, "the device failed");
                               }});
    result["recolour"]["set_color"] = seconds[0];
    if (evaluator)
        result["recolour"]["set_color_to_fence"] = seconds[1];
}

/// Primitive 0 moved by one knot spacing, and what a new document of that scene gives.
void edit(Bench& bench, Json& result) {
    say(bench, "shape edit");
    DocumentOptions with;
    with.threads = bench.options.threads;
    Result<SceneDocument> opened = SceneDocument::open(bench.options.scene, with);
    if (!opened)
        throw Error(opened.error());
    SceneDocument& document = opened.value();
    latency(bench, document, result);
    const nlohmann::json path = nlohmann::json::parse(document.scene())["layers"][0]["primitives"][0]["path"];
    const nlohmann::json point = path["type"] == "circle" ? path["center"] : path["points"][0];
    if (!point.is_array()) {
        result["edit"] = nullptr;
        return;
    }
    const double step = bench.scene.knot_spacing * bench.build.unit / std::sqrt(2.0);
    double at[3] = {point[0], point[1], point[2]};
    std::vector<double> seconds;
    for (int k = 0; k < 3; ++k) {
        at[0] += k % 2 == 0 ? step : -step;
        at[1] += k % 2 == 0 ? step : -step;
        seconds.push_back(seconds_of([&] {
            const Result<Change> moved = document.move_point("/layers/0/primitives/0", 0, {at[0], at[1], at[2]});
            if (!moved)
                throw Error(moved.error());
        }));
    }
    std::sort(seconds.begin(), seconds.end());
    Scene scene = parse_scene(nlohmann::json::parse(document.scene()), bench.options.scene);
    Warnings warnings;
    const MeshAsset asset = MeshAsset::read(scene.mesh_file, scene.mesh_select, warnings);
    const RawMesh& mesh = asset.mesh();
    BuildOptions build_options;
    build_options.threads = bench.options.threads;
    const Build again = pvg::build(scene, {mesh.points, mesh.normals, mesh.faces}, build_options, warnings);
    const Evaluation a = evaluate_on_cpu(document.program()), b = evaluate_on_cpu(again.program);
    double worst = 0, range = 1e-300;
    bench.expect(a.values.size() == b.values.size(), "the edited document has other fields than a build");
    for (std::size_t f = 0; f < std::min(a.values.size(), b.values.size()); ++f) {
        bench.expect(a.values[f].size() == b.values[f].size(), "the edited document has other rows than a build");
        for (std::size_t i = 0; i < std::min(a.values[f].size(), b.values[f].size()); ++i) {
            worst = std::max(worst, std::abs(double{a.values[f][i]} - b.values[f][i]));
            range = std::max(range, std::abs(double{b.values[f][i]}));
        }
    }
    bench.expect(worst <= 1e-4 * range, "the edited document is not what a build gives");
    result["edit"] = {{"seconds", seconds[1]}, {"cells", document.knot_count()}};
    result["ratios"]["build_of_edit"] = bench.total / seconds[1];
    result["ratios"]["fem_refactor_of_edit"] = result["rivals"]["fem_refactor"].get<double>() / seconds[1];
}

void print(const Json& result) {
    const auto row = [](const char* name, double value, const char* unit) {
        std::printf("%-28s %12.4g %s\n", name, value, unit);
    };
    std::printf("%s vertices, %s knots, %s channels, %s threads, %s\n", result["vertices"].dump().c_str(),
                result["knots"].dump().c_str(), result["channels"].dump().c_str(), result["threads"].dump().c_str(),
                result["device"].dump().c_str());
    for (const char* group : {"stages", "recolour", "geodesics", "edit", "rivals", "ratios"}) {
        if (!result.contains(group) || result[group].is_null())
            continue;
        std::printf("%s\n", group);
        for (const auto& [name, value] : result[group].items())
            if (value.is_number())
                row(("  " + name).c_str(), value.get<double>(), "");
            else if (value.is_string())
                std::printf("%-28s %s\n", ("  " + name).c_str(), value.get<std::string>().c_str());
    }
    std::printf("%s\n", result["verified"].get<bool>() ? "verified" : "NOT verified");
}

int run(const Options& options) {
    Bench bench{options, read_scene(options.scene), {}, 0, 0, true, {}};
    if (bench.scene.basis != BasisKind::local)
        throw Error(ErrorKind::bad_input,
                    options.scene.string() + ": /basis/kind: expected \"local\", the basis that is measured");
    Warnings warnings;
    const MeshAsset asset = MeshAsset::read(bench.scene.mesh_file, bench.scene.mesh_select, warnings);
    const RawMesh& mesh = asset.mesh();
    say(bench, "build");
    BuildOptions build_options;
    build_options.threads = options.threads;
    build_options.keep_forms = true;
    bench.total = seconds_of([&] {
        bench.build = pvg::build(bench.scene, {mesh.points, mesh.normals, mesh.faces}, build_options, warnings);
    });
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    if (bench.build.domains.empty())
        throw Error(ErrorKind::bad_input, options.scene.string() + ": no primitive gives a value, there is nothing to measure");
    std::size_t knots = 0;
    for (std::size_t d = 0; d < bench.build.domains.size(); ++d) {
        knots += bench.build.domains[d].knots.vertex.size();
        if (bench.build.arrangement.domains[d].surface.vertex_count() > bench.domain().surface.vertex_count())
            bench.largest = static_cast<int>(d);
    }
    Json result;
    result["vertices"] = bench.build.arrangement.output.vertex_count();
    result["knots"] = knots;
    result["channels"] = bench.domain().channels;
    result["threads"] = options.threads > 0 ? options.threads : static_cast<int>(std::thread::hardware_concurrency());
    result["device"] = nullptr;
    for (const auto& [name, seconds] : bench.build.seconds) result["stages"][name] = seconds;
    result["stages"]["total"] = bench.total;
    result["peak_memory"] = static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
    recolour(bench, result);
    if (options.geodesics)
        geodesics(bench, result);
    if (options.edit)
        edit(bench, result);
    result["verified"] = bench.verified;
    result["failures"] = bench.failures;
    if (options.json)
        std::printf("%s\n", result.dump(2).c_str());
    else
        print(result);
    for (const std::string& failure : bench.failures) std::fprintf(stderr, "not verified: %s\n", failure.c_str());
    return bench.verified ? 0 : static_cast<int>(ErrorKind::check_failed);
}

}  // namespace
}  // namespace pvg::bench

int main(int argc, char** argv) {
    pvg::bench::Options options;
    CLI::App app{"Times every stage and the rivals, side by side in one run", "pvg bench"};
    app.add_option("SCENE", options.scene, "Scene file NAME.pvg.json")->required();
    app.add_flag("--json", options.json, "Print one JSON document instead of a table");
    app.add_flag("-q,--quiet", options.quiet, "No progress");
    app.add_option("--threads", options.threads, "Threads, 0: all cores")->capture_default_str();
    app.add_option("--rounds", options.rounds, "Timed rounds of what is fast; medians are printed")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    app.add_flag("!--no-geodesics", options.geodesics, "Leave out CGAL's geodesics (slow beyond 100,000 vertices)");
    app.add_flag("!--no-edit", options.edit, "Leave out the shape edit");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : static_cast<int>(pvg::ErrorKind::usage);
    }
    try {
        return pvg::bench::run(options);
    } catch (const pvg::Error& error) {
        std::fprintf(stderr, "pvg bench: %s\n", error.what());
        return static_cast<int>(error.kind());
    } catch (const std::exception& error) {
        std::fprintf(stderr, "pvg bench: internal error: %s\n", error.what());
        return static_cast<int>(pvg::ErrorKind::bad_input);
    }
}
