// The vertex attributes of an output primitive: interpolated, renormalised, recomputed or replaced, each by its meaning.
#pragma once

#include <string>
#include <vector>

#include "gltf/output_mesh.h"

namespace pvg::gltf {

/// Numbers for one accessor. component_type is what they are to be written as; integers are exact in float.
struct OutputAttribute {
    std::string name;
    std::string type;
    int component_type = TINYGLTF_COMPONENT_TYPE_FLOAT;
    bool normalized = false;
    std::size_t components = 0;
    std::vector<float> values;
};

/// What the writer needs to know beyond the geometry.
struct AttributeContext {
    const DecoratedMesh* mesh = nullptr;
    const RawPrimitive* primitive = nullptr;
    const OutputPrimitive* output = nullptr;
    std::string place;  ///< "FILE: /meshes/0/primitives/1", for messages
    bool fields = false;
    std::array<float, 3> base_color{1, 1, 1};  ///< the material's old factor, folded into undecorated colours
    int tangent_texcoord = 0;                  ///< set that tangents follow
    std::size_t joint_count = SIZE_MAX;        ///< of the smallest skin that a node shows the mesh with
};

struct OutputAttributes {
    std::vector<OutputAttribute> attributes;
    std::vector<std::vector<OutputAttribute>> targets;
};

OutputAttributes output_attributes(const AttributeContext& context, Warnings& warnings);
/// Only the _PVG_* attributes, for a primitive that is unchanged.
std::vector<OutputAttribute> field_attributes(const AttributeContext& context);

}  // namespace pvg::gltf
