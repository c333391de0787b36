#include "gltf/asset.h"

#include <algorithm>
#include <cctype>

#include "gltf/import_mesh.h"
#include "gltf/load.h"
#include "gltf/state.h"

namespace pvg {

MeshAsset::MeshAsset() : state_(std::make_unique<State>()) {}
MeshAsset::~MeshAsset() = default;
MeshAsset::MeshAsset(MeshAsset&&) noexcept = default;
MeshAsset& MeshAsset::operator=(MeshAsset&&) noexcept = default;

const RawMesh& MeshAsset::mesh() const { return state_->raw; }

MeshAsset MeshAsset::read(const std::filesystem::path& file, const std::optional<std::string>& select, Warnings& warnings) {
    MeshAsset asset;
    if (is_mesh_file(file)) {
        auto [json, bin] = gltf::mesh_document(read_mesh_file(file, warnings));
        asset.state_->document = gltf::adopt(file.string(), std::move(json), std::move(bin), warnings);
    } else {
        asset.state_->document = gltf::load(file, warnings);
    }
    asset.state_->mesh = gltf::select_mesh(asset.state_->document, select);
    asset.state_->primitives = gltf::read_primitives(asset.state_->document, asset.state_->mesh, asset.state_->raw, warnings);
    return asset;
}

std::optional<nlohmann::json> MeshAsset::embedded_scene() const {
    const gltf::Json& mesh = state_->document.json["meshes"][state_->mesh];
    if (!mesh.contains("extras") || !mesh["extras"].is_object() || !mesh["extras"].contains("pvg"))
        return std::nullopt;
    const gltf::Json& pvg = mesh["extras"]["pvg"];
    if (!pvg.is_object() || !pvg.contains("scene"))
        return std::nullopt;
    return nlohmann::json::parse(pvg["scene"].dump());
}

}  // namespace pvg
