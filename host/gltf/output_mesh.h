// The decorated mesh as glTF vertices and triangles, primitive by primitive. One glTF vertex stands for each distinct combination
// of output vertex, the raw vertices that it interpolates, and shading normal: so seams of the input stay seams, and smooth stays
// shared.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "gltf/asset.h"
#include "gltf/primitives.h"

namespace pvg::gltf {

struct OutputVertex {
    int vertex = none;                         ///< of the decorated mesh; none: a raw vertex of a triangle that welding left out
    std::array<int, 3> raw{none, none, none};  ///< raw vertices of the primitive (numbered from its first), unused ones none
    std::array<double, 3> weight{1, 0, 0};
    int normal = none;  ///< in DecoratedMesh::normals, or none: the input's, interpolated
    int wall = none;    ///< the wall that it belongs to: flat normal

    bool is_raw() const { return raw[1] == none; }
};

struct OutputPrimitive {
    bool changed = false;    ///< its triangles or vertices differ from the input's
    bool decorated = false;  ///< a field reaches it
    std::vector<OutputVertex> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// One for each raw primitive, in order. An unchanged one has all its raw vertices, in order, and no triangles: its indices stay
/// as they are. Throws Error(bad_input) when the decorated mesh does not fit the raw one.
std::vector<OutputPrimitive> output_primitives(const RawMesh& raw, const std::vector<RawPrimitive>& primitives,
                                               const DecoratedMesh& mesh, const std::vector<Face>& welded_faces, bool fields);

}  // namespace pvg::gltf
