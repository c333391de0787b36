// pvg check: GPU against CPU, and both against the finite-element oracle on the same vertices.
#include <cmath>
#include <cstdio>

#include "app/device.h"
#include "app/project.h"
#include "app/verbs.h"
#include "cpu_reference/agreement.h"
#include "cpu_reference/finite_elements.h"

namespace pvg::app {
namespace {

struct Tolerance {
    double mean = 0, max = 0, h1 = 0;
};

Tolerance parse_tolerance(const std::string& text) {
    Tolerance t;
    char rest = 0;
    if (std::sscanf(text.c_str(), "%lf,%lf,%lf%c", &t.mean, &t.max, &t.h1, &rest) != 3 || !(t.mean >= 0) || !(t.max >= 0) ||
        !(t.h1 >= 0))
        throw Error(ErrorKind::usage, "--tolerance: expected three numbers MEAN,MAX,H1, found \"" + text + "\"");
    return t;
}

FemProblem fem_problem(const Domain& domain) {
    FemProblem problem;
    problem.points = domain.surface.points();
    problem.faces = domain.surface.faces();
    for (int v = 0; v < domain.surface.vertex_count(); ++v)
        if (domain.dirichlet[v])
            problem.dirichlet.emplace_back(v, domain.dirichlet_value.row(v));
    for (const Coupling& coupling : domain.couplings) problem.jumps.push_back({coupling.left, coupling.right, coupling.jump});
    problem.laplacian = Eigen::MatrixXd::Zero(domain.surface.face_count(), domain.channels);
    for (const SourceColumn& source : domain.sources)
        for (const auto& [face, profile] : source.profile) problem.laplacian.row(face) += profile * source.value;
    return problem;
}

/// A field's evaluated values in the order of its domain's vertices.
Eigen::MatrixXd by_vertex(const Table& table, const std::vector<float>& rows) {
    Eigen::MatrixXd values(table.row_count, table.channels);
    for (std::uint32_t v = 0; v < table.row_count; ++v)
        for (std::uint32_t c = 0; c < table.channels; ++c)
            values(v, c) = rows[static_cast<std::size_t>(table.vertex_row[v]) * table.channels + c];
    return values;
}

/// "r", "g", "b", "a", "height", with the layer's name (or number) before them when there are several layers.
std::vector<std::string> channel_names(const Scene& scene, const Arrangement& arrangement, int domain) {
    std::vector<std::string> names(arrangement.domains[domain].channels);
    static constexpr const char* rgba[] = {"r", "g", "b", "a"};
    for (std::size_t l = 0; l < arrangement.layers.size(); ++l) {
        const LayerFields& fields = arrangement.layers[l];
        std::string prefix;
        if (scene.layers.size() > 1)
            prefix = (scene.layers[l].name.empty() ? std::to_string(l) : scene.layers[l].name) + "/";
        if (fields.color_domain == domain)
            for (int c = 0; c < 4; ++c) names[fields.color_channel + c] = prefix + rgba[c];
        if (fields.height_domain == domain)
            names[fields.height_channel] = prefix + "height";
    }
    return names;
}

/// Mean and largest |lambda - truth| at the knots, % of the channel's error_scale.
nlohmann::ordered_json lambda_error(const SolvedDomain& solved, const Eigen::MatrixXd& truth, int channel, double size) {
    double sum = 0, area = 0, worst = 0;
    for (std::size_t j = 0; j < solved.knots.vertex.size(); ++j) {
        const double error =
            std::abs(solved.lambda(static_cast<Eigen::Index>(j), channel) - truth(solved.knots.vertex[j], channel));
        sum += solved.voronoi.area[j] * error;
        area += solved.voronoi.area[j];
        worst = std::max(worst, error);
    }
    const double scale = size > 0 ? 100 / size : 0;
    return {{"mean", area > 0 ? sum / area * scale : 0}, {"max", worst * scale}};
}

void print_table(const nlohmann::ordered_json& result) {
    std::printf("%-20s %10s %10s %10s   %10s %10s\n", "channel", "mean %", "max %", "H1 %", "knots mean", "knots max");
    for (const auto& [channel, error] : result["bases"]["local"].items()) {
        const auto& lambda = result["lambda"][channel];
        std::printf("%-20s %10.4f %10.4f %10.3f   %10.4f %10.4f\n", channel.c_str(), error["mean"].get<double>(),
                    error["max"].get<double>(), error["h1"].get<double>(), lambda["mean"].get<double>(),
                    lambda["max"].get<double>());
    }
    const auto& agreement = result["gpu_cpu"];
    if (agreement.is_null())
        std::printf("GPU against CPU: no Vulkan device, not compared\n");
    else
        std::printf("GPU against CPU on %s: %s, at most %.0f ulp apart\n", agreement["device"].get<std::string>().c_str(),
                    agreement["bit_identical"].get<bool>() ? "bit-identical" : "not bit-identical",
                    agreement["max_ulp"].get<double>());
    std::printf("%s\n", result["ok"].get<bool>() ? "ok" : "NOT ok: past the tolerance");
}

}  // namespace

int check(const CheckOptions& options, Console& console) {
    const Tolerance tolerance = parse_tolerance(options.tolerance);
    const DeviceChoice choice = parse_device(options.device);
    Warnings warnings;
    const Project project = open_project(options.scene, options.assignments, options.threads, console, warnings);
    const Arrangement& arrangement = project.build.arrangement;

    const DeviceResult cpu =
        evaluate(project.build.program, {.kind = DeviceChoice::Kind::cpu, .name = {}}, options.threads, warnings);
    nlohmann::ordered_json agreement = nullptr;
    bool ok = true;
    if (choice.kind != DeviceChoice::Kind::cpu) {
        std::string reason;
        const std::optional<DeviceResult> gpu = evaluate_on_vulkan(project.build.program, choice, reason);
        if (!gpu && choice.kind == DeviceChoice::Kind::vulkan)
            throw Error(ErrorKind::device, "--device: " + reason);
        if (!gpu)
            warnings.push_back("no Vulkan device (" + reason + "); GPU and CPU are not compared");
        if (gpu) {
            const Agreement both = compare_evaluations(gpu->evaluation, cpu.evaluation);
            agreement = {{"device", gpu->name}, {"max_ulp", both.max_ulp}, {"bit_identical", both.bit_identical}};
            if (!both.bit_identical) {
                const std::string beyond = first_beyond_bound(project.build.program, gpu->evaluation);
                if (!beyond.empty()) {
                    ok = false;
                    warnings.push_back(gpu->name + ": " + beyond);
                }
            }
        }
    }

    nlohmann::ordered_json local = nlohmann::ordered_json::object(), lambda = nlohmann::ordered_json::object();
    for (std::size_t d = 0; d < arrangement.domains.size(); ++d) {
        console.stage(7, 9, "finite elements");
        const Domain& domain = arrangement.domains[d];
        const FemProblem problem = fem_problem(domain);
        const Eigen::MatrixXd truth = solve_finite_elements(problem);
        const std::vector<FieldError> errors =
            compare_fields(problem, truth, by_vertex(project.build.program.fields[d].table, cpu.evaluation.values[d]));
        const Eigen::RowVectorXd scale = error_scale(problem, truth);
        const std::vector<std::string> names = channel_names(project.scene, arrangement, static_cast<int>(d));
        for (int c = 0; c < domain.channels; ++c) {
            local[names[c]] = {{"mean", errors[c].mean}, {"max", errors[c].max}, {"h1", errors[c].h1}};
            lambda[names[c]] = lambda_error(project.build.domains[d], truth, c, scale[c]);
            if (!(errors[c].mean <= tolerance.mean && errors[c].max <= tolerance.max && errors[c].h1 <= tolerance.h1))
                ok = false;
        }
    }
    console.stages_done();
    console.warn(warnings);
    const nlohmann::ordered_json result = {
        {"ok", ok},
        {"bases", {{"local", local}}},
        {"lambda", lambda},
        {"gpu_cpu", agreement},
        {"tolerance", {{"mean", tolerance.mean}, {"max", tolerance.max}, {"h1", tolerance.h1}}}};
    if (options.json)
        std::printf("%s\n", result.dump(2).c_str());
    else
        print_table(result);
    return ok ? 0 : static_cast<int>(ErrorKind::check_failed);
}

}  // namespace pvg::app
