// The triangle primitives of one mesh, read and checked: together one raw soup (RawMesh), each with all its attributes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gltf/asset.h"
#include "gltf/document.h"

namespace pvg::gltf {

/// One vertex attribute, decoded: count x components.
struct Attribute {
    std::string name;
    std::string type;
    int component_type = 0;   ///< as stored
    bool normalized = false;  ///< as stored
    std::size_t components = 0;
    std::vector<float> values;

    const float* at(std::size_t vertex) const { return values.data() + vertex * components; }
};

/// A primitive of triangles. Raw vertices [first_vertex, first_vertex + vertex_count) and raw faces [first_face, first_face +
/// face_count) are its.
struct RawPrimitive {
    std::size_t number = 0;  ///< in the mesh
    std::size_t first_vertex = 0, vertex_count = 0;
    std::size_t first_face = 0, face_count = 0;
    int material = none;
    std::vector<Attribute> attributes;            ///< in the file's order
    std::vector<std::vector<Attribute>> targets;  ///< morph targets

    const Attribute* find(const std::string& name) const;
    bool owns_face(int raw_face) const { return static_cast<std::size_t>(raw_face) - first_face < face_count; }
};

/// The mesh that `select` names: a mesh name, else a node's, else an index. Throws Error(bad_input) listing the names.
std::size_t select_mesh(const Document& document, const std::optional<std::string>& select);

/// Appends to raw; throws Error(bad_input) where an attribute has a wrong form, an index is out of range or a number is not
/// finite.
std::vector<RawPrimitive> read_primitives(const Document& document, std::size_t mesh, RawMesh& raw, Warnings& warnings);

/// "TEXCOORD_2" begins with "TEXCOORD_".
bool is_set_of(const std::string& name, const char* semantic);

}  // namespace pvg::gltf
