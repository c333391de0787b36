// From a file to a checked Document. tinygltf parses what was checked here first; it opens no file and decodes no image.
#pragma once

#include <filesystem>

#include "gltf/document.h"

namespace pvg::gltf {

/// A .glb or .gltf. Throws Error(bad_input) "FILE: /json/pointer: ...".
Document load(const std::filesystem::path& file, Warnings& warnings);
/// A document made in memory (one buffer, `bin`), through the same checks.
Document adopt(const std::string& file, Json json, Bytes bin, Warnings& warnings);

/// Checks of the parts; adopt() and load() call them. structure.cpp.
void check_asset(const Document& document, Warnings& warnings);
void check_buffer_views(const Place& root);
void check_accessors(const Place& root);
void check_meshes(const Place& root);
void check_nodes_and_scenes(const Place& root);

}  // namespace pvg::gltf
