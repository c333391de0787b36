// pvg decorate: the main job.
#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <cstdio>

#include "app/compose.h"
#include "app/device.h"
#include "app/project.h"
#include "app/verbs.h"

namespace pvg::app {
namespace {

using Clock = std::chrono::steady_clock;

double since(Clock::time_point started) { return std::chrono::duration<double>(Clock::now() - started).count(); }

/// Stored pairs, padding and sources included, a vertex that no diffusion curve fixes.
double entries_per_vertex(const Build& build) {
    double pairs = 0, vertices = 0;
    for (std::size_t d = 0; d < build.program.fields.size(); ++d) {
        const Table& table = build.program.fields[d].table;
        for (std::uint32_t c = 0; c < table.cell_count; ++c) {
            const double width = table.cell_first_index[c + 1] - table.cell_first_index[c];
            for (std::uint32_t r = table.cell_first_row[c]; r < table.cell_first_row[c + 1]; ++r) {
                if (build.arrangement.domains[d].dirichlet[table.row_vertex[r]])
                    continue;
                pairs += width;
                ++vertices;
            }
        }
    }
    return vertices > 0 ? pairs / vertices : 0;
}

nlohmann::ordered_json report_of(const Project& project, const DecoratedMesh& mesh, const DeviceResult& device,
                                 double write_seconds, double total, const Warnings& warnings) {
    const Build& build = project.build;
    std::size_t primitives = 0, knots = 0, unknowns = 0, bytes = 0, decorated = 0;
    for (const Layer& layer : project.scene.layers)
        for (const Primitive& primitive : layer.primitives) primitives += primitive.enabled ? 1 : 0;
    for (const SolvedDomain& domain : build.domains) {
        knots += domain.knots.vertex.size();
        unknowns += domain.system.unknowns();
    }
    for (const Field& field : build.program.fields) bytes += field.table.bytes();
    for (char flag : mesh.decorated) decorated += flag ? 1 : 0;

    nlohmann::ordered_json stages;
    stages["read"] = project.read_seconds;
    for (const char* name : {"curves", "knots", "voronoi", "system", "basis"}) {
        stages[name] = 0.0;
        for (const auto& [stage, seconds] : build.seconds)
            if (stage == name)
                stages[name] = seconds;
    }
    stages["upload"] = device.upload_seconds;
    stages["evaluate"] = device.evaluate_seconds;
    stages["write"] = write_seconds;

    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return {{"pvg", PVG_VERSION},
            {"scene", project.scene.file.string()},
            {"device", {{"name", device.name}, {"type", device.type}}},
            {"vertices",
             {{"in", build.welded.surface.vertex_count()},
              {"out", build.arrangement.output.vertex_count()},
              {"decorated", decorated}}},
            {"primitives", primitives},
            {"knots", knots},
            {"unknowns", unknowns},
            {"cells", knots},
            {"table", {{"entries_per_vertex", entries_per_vertex(build)}, {"bytes", bytes}}},
            {"stages", stages},
            {"total", total},
            {"peak_memory", static_cast<std::uint64_t>(usage.ru_maxrss) * 1024},
            {"warnings", warnings}};
}

}  // namespace

int decorate(const DecorateOptions& options, Console& console) {
    const auto started = Clock::now();
    if (options.out.extension() != ".glb")
        throw Error(ErrorKind::usage, "-o: expected a name that ends in .glb, found \"" + options.out.string() + "\"");
    const DeviceChoice choice = parse_device(options.device);
    Warnings warnings;
    Project project = open_project(options.scene, {options.assignments, options.basis, options.threads}, console, warnings);

    console.stage(7, 9, "evaluate");
    if (options.no_displace)
        project.build.program.unit = 0;
    const DeviceResult device = evaluate(project.build.program, choice, options.threads, warnings);
    const DecoratedMesh mesh =
        compose(project.scene, project.asset.mesh(), project.build, device.evaluation, {.displace = !options.no_displace});

    console.stage(8, 9, "write");
    const auto write_started = Clock::now();
    project.asset.write(options.out, mesh, project.build.welded.raw_to_welded,
                        {.fields = options.fields, .scene = project.scene.document}, warnings);
    const double write_seconds = since(write_started);

    console.stages_done();
    console.warn(warnings);
    const nlohmann::ordered_json report = report_of(project, mesh, device, write_seconds, since(started), warnings);
    if (options.report)
        write_text(*options.report, report.dump(2) + "\n");
    char line[512];
    std::snprintf(line, sizeof line, "%s: %d vertices, %zu decorated, %zu knots, %.1f entries a vertex, %s, %.2f s",
                  options.out.c_str(), report["vertices"]["out"].get<int>(), report["vertices"]["decorated"].get<std::size_t>(),
                  report["knots"].get<std::size_t>(), report["table"]["entries_per_vertex"].get<double>(), device.name.c_str(),
                  report["total"].get<double>());
    console.say(line);
    for (const auto& [stage, seconds] : report["stages"].items()) {
        std::snprintf(line, sizeof line, "  %-9s %8.3f s", stage.c_str(), seconds.get<double>());
        console.note(line);
    }
    return 0;
}

}  // namespace pvg::app
