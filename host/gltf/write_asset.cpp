// MeshAsset::write: edits a copy of the input's JSON; nothing that is not decorated changes.
#include <algorithm>

#include "gltf/edition.h"
#include "gltf/files.h"
#include "gltf/materials.h"
#include "gltf/output_attributes.h"
#include "gltf/repair.h"
#include "gltf/state.h"

namespace pvg {
namespace {

using gltf::Json;

/// Joints of the smallest skin that a node shows the mesh with.
std::size_t joints_of(const Json& json, std::size_t mesh) {
    std::size_t least = SIZE_MAX;
    if (json.contains("nodes"))
        for (const Json& node : json["nodes"])
            if (node.contains("mesh") && node.contains("skin") && node["mesh"].get<std::size_t>() == mesh)
                least = std::min(least, json["skins"][node["skin"].get<std::size_t>()]["joints"].size());
    return least;
}

void warn_of_sharing(const gltf::Document& document, std::size_t mesh, Warnings& warnings) {
    std::vector<std::string> nodes;
    if (document.json.contains("nodes"))
        for (std::size_t n = 0; n < document.json["nodes"].size(); ++n) {
            const Json& node = document.json["nodes"][n];
            if (!node.contains("mesh") || node["mesh"].get<std::size_t>() != mesh)
                continue;
            nodes.push_back(node.contains("name") ? "\"" + node["name"].get<std::string>() + "\"" : std::to_string(n));
        }
    if (nodes.size() < 2)
        return;
    std::string list;
    for (std::size_t i = 0; i < nodes.size() && i < 20; ++i) list += (i ? ", " : "") + nodes[i];
    warnings.push_back(document.file + ": " + std::to_string(nodes.size()) +
                       " nodes share the mesh and all show the decoration: " + list + (nodes.size() > 20 ? ", ..." : ""));
}

void remove_extension(Json& json, const char* list, const std::string& name) {
    if (!json.contains(list))
        return;
    Json kept = Json::array();
    for (const Json& extension : json[list])
        if (extension != name)
            kept.push_back(extension);
    if (kept.empty())
        json.erase(list);
    else
        json[list] = std::move(kept);
}

/// Whether any primitive still has an attribute in a form that only KHR_mesh_quantization allows.
bool is_quantized(const Json& json) {
    const auto form = [&](const std::string& name, const Json& index, bool delta) {
        const Json& accessor = json["accessors"][index.get<std::size_t>()];
        const auto type = accessor["componentType"].get<int>();
        if (type == TINYGLTF_COMPONENT_TYPE_FLOAT)
            return false;
        if (name == "POSITION" || name == "NORMAL" || name == "TANGENT")
            return true;
        const bool is_unsigned = type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
        const bool normalized = accessor.contains("normalized") && accessor["normalized"].get<bool>();
        return gltf::is_set_of(name, "TEXCOORD_") && (delta || !is_unsigned || !normalized);
    };
    for (const Json& mesh : json["meshes"])
        for (const Json& primitive : mesh["primitives"]) {
            for (const auto& [name, index] : primitive["attributes"].items())
                if (form(name, index, false))
                    return true;
            if (primitive.contains("targets"))
                for (const Json& target : primitive["targets"])
                    for (const auto& [name, index] : target.items())
                        if (form(name, index, true))
                            return true;
        }
    return false;
}

bool uses_draco(const Json& json) {
    for (const Json& mesh : json["meshes"])
        for (const Json& primitive : mesh["primitives"])
            if (primitive.contains("extensions") && primitive["extensions"].contains("KHR_draco_mesh_compression"))
                return true;
    return false;
}

std::size_t add(gltf::Edition& edition, const gltf::OutputAttribute& attribute) {
    return edition.add_attribute(attribute.values, attribute.type, attribute.component_type, attribute.normalized,
                                 attribute.name == "POSITION");
}

/// Attributes by name: those the input has keep their place in the order.
Json attribute_map(gltf::Edition& edition, const Json& before, const std::vector<gltf::OutputAttribute>& attributes) {
    Json map = Json::object();
    for (const auto& [name, accessor] : before.items())
        for (const gltf::OutputAttribute& attribute : attributes)
            if (attribute.name == name)
                map[name] = nullptr;
    for (const gltf::OutputAttribute& attribute : attributes) map[attribute.name] = add(edition, attribute);
    return map;
}

void write_primitive(gltf::Edition& edition, Json& primitive, const gltf::AttributeContext& context, Warnings& warnings) {
    const gltf::OutputAttributes made = gltf::output_attributes(context, warnings);
    primitive["attributes"] = attribute_map(edition, primitive["attributes"], made.attributes);
    for (std::size_t t = 0; t < made.targets.size(); ++t)
        primitive["targets"][t] = attribute_map(edition, primitive["targets"][t], made.targets[t]);
    std::vector<std::uint32_t> indices;
    indices.reserve(context.output->triangles.size() * 3);
    for (const auto& triangle : context.output->triangles) indices.insert(indices.end(), triangle.begin(), triangle.end());
    primitive["indices"] = edition.add_indices(indices, context.output->vertices.size());
    primitive.erase("mode");
    if (primitive.contains("extensions") && primitive["extensions"].contains("KHR_draco_mesh_compression")) {
        primitive["extensions"].erase("KHR_draco_mesh_compression");
        if (primitive["extensions"].empty())
            primitive.erase("extensions");
    }
}

void embed_scene(Json& mesh, const nlohmann::json& scene) {
    if (scene.is_null())
        return;
    Json extras = mesh.contains("extras") ? mesh["extras"] : Json::object();
    if (!extras.is_object())
        extras = Json{{"value", extras}};
    extras["pvg"] = Json{{"version", PVG_VERSION}, {"scene", Json::parse(scene.dump())}};
    mesh["extras"] = std::move(extras);
}

}  // namespace

void MeshAsset::write(const std::filesystem::path& out, const DecoratedMesh& mesh, const std::vector<Face>& welded_faces,
                      const WriteOptions& options, Warnings& warnings) const {
    const gltf::Document& document = state_->document;
    const auto primitives = gltf::output_primitives(state_->raw, state_->primitives, mesh, welded_faces, options.fields);
    gltf::Edition edition(document);
    Json& json = edition.json;
    gltf::repair_bounds(document, json, warnings);
    gltf::repair_scenes(document, json, warnings);

    gltf::WhiteMaterials materials;
    std::vector<int> textured;
    const std::string mesh_place = document.file + ": /meshes/" + std::to_string(state_->mesh);
    for (std::size_t p = 0; p < primitives.size(); ++p) {
        const gltf::RawPrimitive& raw = state_->primitives[p];
        if (!primitives[p].changed && !options.fields)
            continue;
        if (raw.face_count == 0)
            continue;
        Json primitive = json["meshes"][state_->mesh]["primitives"][raw.number];
        gltf::AttributeContext context;
        context.mesh = &mesh;
        context.primitive = &raw;
        context.output = &primitives[p];
        context.place = mesh_place + "/primitives/" + std::to_string(raw.number);
        context.fields = options.fields;
        context.base_color = gltf::base_color(json, raw.material);
        context.tangent_texcoord = gltf::normal_map_texcoord(json, raw.material);
        context.joint_count = joints_of(json, state_->mesh);
        if (primitives[p].changed) {
            write_primitive(edition, primitive, context, warnings);
        } else {
            for (const gltf::OutputAttribute& attribute : gltf::field_attributes(context))
                primitive["attributes"][attribute.name] = add(edition, attribute);
        }
        if (primitives[p].decorated) {
            if (gltf::WhiteMaterials::has_color_texture(json, raw.material))
                textured.push_back(raw.material);
            primitive["material"] = materials.copy_of(json, raw.material);
        }
        json["meshes"][state_->mesh]["primitives"][raw.number] = std::move(primitive);
    }
    gltf::repair_weights(document, edition, warnings);
    std::sort(textured.begin(), textured.end());
    textured.erase(std::unique(textured.begin(), textured.end()), textured.end());
    for (int material : textured)
        warnings.push_back(
            document.file + ": /materials/" + std::to_string(material) +
            ": its base colour texture still multiplies the decoration; --bake-texture draws into the texture instead");

    if (!is_quantized(json)) {
        remove_extension(json, "extensionsRequired", "KHR_mesh_quantization");
        remove_extension(json, "extensionsUsed", "KHR_mesh_quantization");
    }
    if (!uses_draco(json))
        remove_extension(json, "extensionsUsed", "KHR_draco_mesh_compression");
    embed_scene(json["meshes"][state_->mesh], options.scene);
    warn_of_sharing(document, state_->mesh, warnings);
    write_file_atomically(out, edition.glb());
}

}  // namespace pvg
