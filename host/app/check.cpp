// pvg check: GPU against CPU, and every basis against the finite-element oracle on the same vertices.
#include <cstdio>
#include <utility>

#include "app/bases.h"
#include "app/device.h"
#include "app/project.h"
#include "app/verbs.h"
#include "cpu_reference/agreement.h"

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

using Json = nlohmann::ordered_json;

/// The paper's basis costs one solve a knot: beyond this many only when asked for.
constexpr std::size_t most_knots_for_green = 3000;

void print_table(const Json& result) {
    std::printf("%-20s %-10s %10s %10s %10s\n", "channel", "basis", "mean %", "max %", "H1 %");
    const std::string own = result["basis"].get<std::string>();
    for (const auto& [channel, unused] : result["lambda"].items())
        for (const auto& [name, channels] : result["bases"].items()) {
            if (!channels.contains(channel))
                continue;
            const Json& error = channels[channel];
            std::printf("%-20s %-10s %10.4f %10.4f %10.3f%s\n", channel.c_str(), name.c_str(), error["mean"].get<double>(),
                        error["max"].get<double>(), error["h1"].get<double>(), name == own ? "   the scene's" : "");
        }
    std::printf("\n%-20s %-21s %10s %10s\n", "channel", "coefficients at knots", "mean %", "max %");
    for (const auto& [key, title] : {std::pair{"cell_lambda", "cell system"}, std::pair{"lambda", "evaluated"}})
        for (const auto& [channel, error] : result[key].items())
            std::printf("%-20s %-21s %10.4f %10.4f\n", channel.c_str(), title, error["mean"].get<double>(),
                        error["max"].get<double>());
    std::printf("\n");
    for (const Json& item : result["left_out"])
        std::printf("not compared: %s of %s: %s\n", item["basis"].get<std::string>().c_str(),
                    item["channels"].get<std::string>().c_str(), item["reason"].get<std::string>().c_str());
    const Json& agreement = result["gpu_cpu"];
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
    const Project project = open_project(options.scene, {options.assignments, options.basis, options.threads}, console, warnings);
    const Arrangement& arrangement = project.build.arrangement;

    const DeviceResult cpu =
        evaluate(project.build.program, {.kind = DeviceChoice::Kind::cpu, .name = {}}, options.threads, warnings);
    Json agreement = nullptr;
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

    const BasisChoice own = basis_choice(project.scene);
    Json bases = Json::object(), cell_lambda = Json::object(), lambda = Json::object(), left_out = Json::array();
    for (const char* name : {"local", "green", "green_raw", "exact"}) bases[name] = Json::object();
    for (std::size_t d = 0; d < arrangement.domains.size(); ++d) {
        const SolvedDomain& solved = project.build.domains[d];
        const std::vector<std::string> names = channel_names(project.scene, arrangement, static_cast<int>(d));
        BasesOptions with;
        with.own = own;
        with.with_green = own.kind == BasisKind::green || options.all_bases || solved.knots.vertex.size() <= most_knots_for_green;
        with.threads = options.threads;
        with.on_stage = [&](const std::string& stage) { console.stage(7, 9, stage); };
        with.on_progress = [&](double part) { console.progress(part); };
        const DomainErrors errors =
            compare_bases(arrangement.domains[d], solved, project.build.program.fields[d].table, cpu.evaluation.values[d], with);
        for (std::size_t c = 0; c < names.size(); ++c) {
            cell_lambda[names[c]] = {{"mean", errors.cell_lambda[c].mean}, {"max", errors.cell_lambda[c].max}};
            lambda[names[c]] = {{"mean", errors.lambda[c].mean}, {"max", errors.lambda[c].max}};
            for (const DomainErrors::Basis& basis : errors.bases) {
                const FieldError& error = basis.channels[c];
                bases[basis.name][names[c]] = {{"mean", error.mean}, {"max", error.max}, {"h1", error.h1}};
                if (basis.name == basis_name(own) &&
                    !(error.mean <= tolerance.mean && error.max <= tolerance.max && error.h1 <= tolerance.h1))
                    ok = false;
            }
        }
        if (!with.with_green) {
            std::string channels;
            for (const std::string& name : names) channels += (channels.empty() ? "" : ", ") + name;
            left_out.push_back({{"basis", "green"},
                                {"channels", channels},
                                {"reason", std::to_string(solved.knots.vertex.size()) + " knots, more than " +
                                               std::to_string(most_knots_for_green) + "; --all-bases compares it too"}});
        }
    }
    for (const char* name : {"local", "green", "green_raw", "exact"})
        if (bases[name].empty() && !lambda.empty())
            bases.erase(name);
    console.stages_done();
    console.warn(warnings);
    const Json result = {{"ok", ok},
                         {"basis", basis_name(own)},
                         {"bases", bases},
                         {"left_out", left_out},
                         {"lambda", lambda},
                         {"cell_lambda", cell_lambda},
                         {"gpu_cpu", agreement},
                         {"tolerance", {{"mean", tolerance.mean}, {"max", tolerance.max}, {"h1", tolerance.h1}}}};
    if (options.json)
        std::printf("%s\n", result.dump(2).c_str());
    else
        print_table(result);
    return ok ? 0 : static_cast<int>(ErrorKind::check_failed);
}

}  // namespace pvg::app
