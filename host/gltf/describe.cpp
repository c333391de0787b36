#include "gltf/describe.h"

#include <array>

#include "gltf/import_mesh.h"
#include "gltf/load.h"

namespace pvg {
namespace {

using gltf::Json;

std::size_t size_of(const Json& json, const char* key) { return json.contains(key) ? json[key].size() : 0; }

std::size_t triangles(int mode, std::size_t corners) {
    if (mode == TINYGLTF_MODE_TRIANGLES)
        return corners / 3;
    return mode > TINYGLTF_MODE_TRIANGLES && corners >= 3 ? corners - 2 : 0;
}

Json describe_primitive(const Json& json, const Json& primitive) {
    constexpr std::array modes{"points", "lines", "line loop", "line strip", "triangles", "triangle strip", "triangle fan"};
    const int mode = primitive.contains("mode") ? primitive["mode"].get<int>() : TINYGLTF_MODE_TRIANGLES;
    const auto count = [&](const Json& accessor) {
        return json["accessors"][accessor.get<std::size_t>()]["count"].get<std::size_t>();
    };
    const Json& attributes = primitive["attributes"];
    const std::size_t vertices = attributes.contains("POSITION") ? count(attributes["POSITION"]) : 0;
    Json result = {{"mode", modes[static_cast<std::size_t>(mode)]}, {"vertices", vertices}};
    result["triangles"] = triangles(mode, primitive.contains("indices") ? count(primitive["indices"]) : vertices);
    result["attributes"] = Json::array();
    for (const auto& [name, accessor] : attributes.items()) result["attributes"].push_back(name);
    result["targets"] = size_of(primitive, "targets");
    if (primitive.contains("material"))
        result["material"] = primitive["material"];
    return result;
}

}  // namespace

nlohmann::ordered_json describe_mesh_file(const std::filesystem::path& file, Warnings& warnings) {
    gltf::Document document;
    Json result = {{"file", file.string()}};
    if (is_mesh_file(file)) {
        auto [imported, bin] = gltf::mesh_document(read_mesh_file(file, warnings));
        imported["asset"].erase("generator");
        document = gltf::adopt(file.string(), std::move(imported), std::move(bin), warnings);
        result["format"] = file.extension().string().substr(1);
    } else {
        document = gltf::load(file, warnings);
        result["format"] = document.binary ? "glb" : "gltf";
    }
    const Json& json = document.json;
    if (json["asset"].contains("generator"))
        result["generator"] = json["asset"]["generator"];
    result["extensions_used"] = json.contains("extensionsUsed") ? json["extensionsUsed"] : Json::array();
    result["extensions_required"] = json.contains("extensionsRequired") ? json["extensionsRequired"] : Json::array();
    result["meshes"] = Json::array();
    Json embedded = Json::array();
    std::vector<Json> shown(size_of(json, "meshes"), Json::array());
    for (std::size_t n = 0; n < size_of(json, "nodes"); ++n) {
        const Json& node = json["nodes"][n];
        if (node.contains("mesh"))
            shown[node["mesh"].get<std::size_t>()].push_back(node.contains("name") ? node["name"] : Json(n));
    }
    for (std::size_t m = 0; m < size_of(json, "meshes"); ++m) {
        const Json& mesh = json["meshes"][m];
        Json described = {{"index", m}};
        if (mesh.contains("name"))
            described["name"] = mesh["name"];
        std::size_t vertices = 0, faces = 0;
        Json primitives = Json::array();
        for (const Json& primitive : mesh["primitives"]) {
            primitives.push_back(describe_primitive(json, primitive));
            vertices += primitives.back()["vertices"].get<std::size_t>();
            faces += primitives.back()["triangles"].get<std::size_t>();
        }
        described["vertices"] = vertices;
        described["triangles"] = faces;
        described["nodes"] = std::move(shown[m]);
        described["primitives"] = std::move(primitives);
        if (mesh.contains("extras") && mesh["extras"].is_object() && mesh["extras"].contains("pvg"))
            embedded.push_back(m);
        result["meshes"].push_back(std::move(described));
    }
    for (const char* key : {"nodes", "scenes", "materials", "textures", "images", "skins", "animations"})
        result[key] = size_of(json, key);
    result["embedded_scene"] = std::move(embedded);
    return result;
}

}  // namespace pvg
