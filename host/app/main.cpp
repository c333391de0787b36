// The pvg command: reads the command line, runs one verb, turns errors into messages and exit codes.
#include <cstdio>
#include <exception>
#include <new>

#include <CLI/CLI.hpp>

#include "app/verbs.h"
#include "pvg/status.h"

namespace {

using namespace pvg::app;

struct Common {
    bool quiet = false;
    bool verbose = false;
    Loudness loudness() const { return quiet ? Loudness::quiet : verbose ? Loudness::verbose : Loudness::normal; }
};

void add_common(CLI::App& command, Common& common) {
    command.add_flag("-q,--quiet", common.quiet, "Only errors on stderr");
    command.add_flag("-v,--verbose", common.verbose, "Say what is done and how long it took");
}

void add_device(CLI::App& command, std::string& device, int& threads) {
    command.add_option("--device", device, "Where to evaluate: auto, vulkan, vulkan:NAME or cpu")->capture_default_str();
    command.add_option("--threads", threads, "Threads on the CPU, 0 for all cores; the result does not depend on it")
        ->check(CLI::Range(0, 1024))
        ->capture_default_str();
}

void add_basis(CLI::App& command, std::string& basis) {
    command
        .add_option("--basis", basis,
                    "Instead of the scene's basis: local, green (the paper's, truncated) or exact (the paper's, all of it)")
        ->check(CLI::IsMember({"local", "green", "exact"}));
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{
        "Poisson vector graphics on triangle meshes: curves with colours and heights become smooth colours and real relief.",
        "pvg"};
    app.set_version_flag("--version", PVG_VERSION);
    app.require_subcommand(1);
    app.footer(
        "Exit codes: 0 done, 1 a check failed, 2 wrong usage, 3 bad input, 4 no usable device or it failed, 5 the output could "
        "not be written.");
    Common common;

    DecorateOptions decorate_options;
    CLI::App* decorate_command = app.add_subcommand("decorate", "Decorate the mesh of a scene and write a .glb");
    decorate_command->add_option("SCENE", decorate_options.scene, "Scene file NAME.pvg.json")->required();
    decorate_command->add_option("-o,--output", decorate_options.out, "The .glb to write; replaced atomically")->required();
    add_device(*decorate_command, decorate_options.device, decorate_options.threads);
    add_basis(*decorate_command, decorate_options.basis);
    decorate_command->add_flag("--fields", decorate_options.fields,
                               "Add the float attributes _PVG_COLOR, _PVG_HEIGHT, _PVG_DIRICHLET, _PVG_CELL, _PVG_BASE");
    decorate_command->add_flag("--no-displace", decorate_options.no_displace, "Colours only: leave every vertex where it is");
    decorate_command->add_option("--report", decorate_options.report, "Write times, sizes and warnings as JSON");
    decorate_command
        ->add_option("--set", decorate_options.assignments,
                     "Change the scene before it is read: ID.KEY[.KEY...]=VALUE (repeatable)")
        ->take_all();
    add_common(*decorate_command, common);

    CheckOptions check_options;
    CLI::App* check_command = app.add_subcommand("check", "Compare GPU with CPU, and every basis with a finite-element solution");
    check_command->add_option("SCENE", check_options.scene, "Scene file NAME.pvg.json")->required();
    add_device(*check_command, check_options.device, check_options.threads);
    add_basis(*check_command, check_options.basis);
    check_command->add_flag("--all-bases", check_options.all_bases,
                            "Compare the paper's basis also where it is slow: beyond 3,000 knots a domain");
    check_command
        ->add_option("--tolerance", check_options.tolerance,
                     "MEAN,MAX,H1 in % of each channel's range, for the scene's own basis; beyond it the exit code is 1")
        ->capture_default_str();
    check_command
        ->add_option("--set", check_options.assignments, "Change the scene before it is read: ID.KEY[.KEY...]=VALUE (repeatable)")
        ->take_all();
    check_command->add_flag("--json", check_options.json, "Print one JSON document instead of a table");
    add_common(*check_command, common);

    MakeOptions make_options;
    CLI::App* make_command = app.add_subcommand("make", "Write a procedural mesh: cuboid, sphere, plane, torus, vase or stele");
    make_command->add_option("SHAPE", make_options.shape, "cuboid, sphere, plane, torus, vase or stele")->required();
    make_command->add_option("-o,--output", make_options.out, "The .glb to write")->required();
    make_command->add_option("--vertices", make_options.vertices, "About how many vertices")
        ->check(CLI::Range(8, 50'000'000))
        ->capture_default_str();
    add_common(*make_command, common);

    InfoOptions info_options;
    CLI::App* info_command = app.add_subcommand("info", "Say what is in a mesh or a scene");
    info_command->add_option("FILE", info_options.file, "A mesh (.glb .gltf .obj .off .ply) or a scene (.pvg.json)")->required();
    info_command->add_flag("--json", info_options.json, "Print one JSON document instead of a table");
    add_common(*info_command, common);

    DevicesOptions devices_options;
    CLI::App* devices_command = app.add_subcommand("devices", "List the Vulkan devices and which one `auto` takes");
    devices_command->add_flag("--json", devices_options.json, "Print one JSON document instead of a table");
    add_common(*devices_command, common);

    CLI::App* bench_command = app.add_subcommand("bench", "Time every stage and the rivals, side by side in one run");
    bench_command->prefix_command();  // its own options: `pvg bench --help`
    bench_command->set_help_flag();

    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : static_cast<int>(pvg::ErrorKind::usage);
    }

    try {
        Console console(common.loudness());
        if (*decorate_command)
            return decorate(decorate_options, console);
        if (*check_command)
            return check(check_options, console);
        if (*make_command)
            return make(make_options, console);
        if (*info_command)
            return info(info_options, console);
        if (*bench_command)
            return bench(bench_command->remaining());
        return devices(devices_options, console);
    } catch (const pvg::Error& error) {
        Console::fail(error.what());
        return static_cast<int>(error.kind());
    } catch (const std::bad_alloc&) {
        Console::fail("out of memory");
        return static_cast<int>(pvg::ErrorKind::bad_input);
    } catch (const std::exception& error) {
        Console::fail(std::string("internal error: ") + error.what());
        return static_cast<int>(pvg::ErrorKind::bad_input);
    }
}
