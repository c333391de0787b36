// What is in a mesh file, for `pvg info`.
#pragma once

#include <filesystem>

#include <nlohmann/json.hpp>

#include "pvg/status.h"

namespace pvg {

/// {"file", "format", "generator"?, "extensions_used", "extensions_required", "meshes": [{"index", "name"?, "vertices",
/// "triangles", "nodes": [names or numbers], "primitives": [{"mode", "vertices", "triangles", "attributes": [names], "targets",
/// "material"?}]}], "nodes", "scenes", "materials", "textures", "images", "skins", "animations", "embedded_scene": [meshes that
/// carry one]}. Throws Error(bad_input) as MeshAsset::read does, but needs no selection.
nlohmann::ordered_json describe_mesh_file(const std::filesystem::path& file, Warnings& warnings);

}  // namespace pvg
