#include "app/project.h"

#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <fstream>
#include <system_error>

namespace pvg::app {

namespace {

void choose_basis(Scene& scene, const std::string& name) {
    if (name.empty())
        return;
    scene.basis = name == "green" ? BasisKind::green : name == "exact" ? BasisKind::exact : BasisKind::local;
    scene.document["basis"]["kind"] = name;
}

}  // namespace

Project open_project(const std::filesystem::path& scene_file, const ProjectOptions& project, Console& console,
                     Warnings& warnings) {
    const auto started = std::chrono::steady_clock::now();
    const std::string extension = scene_file.extension().string();
    if (extension == ".glb" || extension == ".gltf")
        throw Error(
            ErrorKind::bad_input,
            scene_file.string() + ": this version decorates scenes (NAME.pvg.json); a scene inside a glTF cannot be edited yet");
    console.stage(0, 9, "read");
    Scene scene = read_scene(scene_file, project.assignments);
    choose_basis(scene, project.basis);
    MeshAsset asset = MeshAsset::read(scene.mesh_file, scene.mesh_select, warnings);
    const double read_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();

    const RawMesh& mesh = asset.mesh();
    int stage = 1;
    BuildOptions options;
    options.threads = project.threads;
    options.on_stage = [&](const std::string& name) {
        console.note(name);
        console.stage(stage < 6 ? stage++ : 6, 9, name);
    };
    options.on_progress = [&](double part) { console.progress(part); };
    Build built = build(scene, {mesh.points, mesh.normals, mesh.faces}, options, warnings);
    return {std::move(scene), std::move(asset), std::move(built), read_seconds};
}

void write_text(const std::filesystem::path& file, const std::string& text) {
    std::filesystem::path temporary = file;
    temporary += "." + std::to_string(getpid()) + ".pvg-tmp";
    const auto refuse = [&](const std::string& why) {
        std::error_code ignored;
        std::filesystem::remove(temporary, ignored);
        throw Error(ErrorKind::output, file.string() + ": cannot be written: " + why);
    };
    {
        std::ofstream stream(temporary, std::ios::binary);
        if (!stream)
            refuse("the folder does not exist or is not writable");
        stream << text;
        stream.flush();
        if (!stream)
            refuse("the disk may be full");
    }
    std::error_code error;
    std::filesystem::rename(temporary, file, error);
    if (error)
        refuse(error.message());
}

}  // namespace pvg::app
