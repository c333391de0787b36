// What a MeshAsset holds.
#pragma once

#include "gltf/asset.h"
#include "gltf/document.h"
#include "gltf/primitives.h"

namespace pvg {

struct MeshAsset::State {
    gltf::Document document;
    std::size_t mesh = 0;
    std::vector<gltf::RawPrimitive> primitives;
    RawMesh raw;
};

}  // namespace pvg
