// Triangle meshes of simpler formats (.obj, .off, .ply) and of `pvg make`, and their way into a fresh glTF document.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "gltf/document.h"
#include "mesh/shapes.h"
#include "mesh/surface.h"
#include "pvg/status.h"

namespace pvg {

/// Vertices with attributes (each empty or one a point) and triangles over them.
struct ImportedMesh {
    std::string name;
    std::vector<std::array<float, 3>> points;
    std::vector<std::array<float, 3>> normals;    ///< unit
    std::vector<std::array<float, 2>> texcoords;  ///< glTF's: v grows downwards
    std::vector<std::array<float, 4>> colors;     ///< linear
    std::vector<Face> faces;
};

/// By its ending: .obj, .off or .ply.
bool is_mesh_file(const std::filesystem::path& file);
/// Throws Error(bad_input) "FILE: line N: ..." (or byte N). Polygons are cut into fans of triangles.
ImportedMesh read_mesh_file(const std::filesystem::path& file, Warnings& warnings);
/// normals and texture coordinates as they are.
ImportedMesh imported(const ShapeMesh& shape, const std::string& name);

/// A .glb with one mesh, one node and one scene, written atomically. Throws Error(output).
void write_glb(const std::filesystem::path& out, const ImportedMesh& mesh);
void write_glb(const std::filesystem::path& out, const ShapeMesh& shape, const std::string& name = "");

namespace gltf {

/// The document and its only buffer.
std::pair<Json, Bytes> mesh_document(const ImportedMesh& mesh);

/// One reader a format; `text` is the whole file.
ImportedMesh read_obj(const std::string& file, std::string_view text, Warnings& warnings);
ImportedMesh read_off(const std::string& file, std::string_view text, Warnings& warnings);
ImportedMesh read_ply(const std::string& file, std::string_view text, Warnings& warnings);

}  // namespace gltf
}  // namespace pvg
