// What decorate and check do first: scene, mesh and the pipeline's stages.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "app/console.h"
#include "gltf/asset.h"
#include "scene/scene.h"
#include "solve/build.h"

namespace pvg::app {

struct Project {
    Scene scene;
    MeshAsset asset;
    Build build;
    double read_seconds = 0;
};

struct ProjectOptions {
    std::vector<std::string> assignments;  ///< --set
    std::string basis;                     ///< --basis: "local", "green" or "exact"; empty: the scene's
    int threads = 0;
};

/// Reads the scene and its mesh and builds everything up to the program. The scene (and the document that travels in an output)
/// has the basis that was asked for. Throws Error.
Project open_project(const std::filesystem::path& scene, const ProjectOptions& options, Console& console, Warnings& warnings);

/// Writes a text file atomically (temporary file beside it, then rename). Throws Error(output).
void write_text(const std::filesystem::path& file, const std::string& text);

}  // namespace pvg::app
