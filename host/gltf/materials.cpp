#include "gltf/materials.h"

#include <algorithm>

#include "mesh/surface.h"

namespace pvg::gltf {
namespace {

/// A member of nested objects, or nullptr.
const Json* find(const Json& json, std::initializer_list<const char*> path) {
    const Json* at = &json;
    for (const char* key : path) {
        if (!at->is_object() || !at->contains(key))
            return nullptr;
        at = &(*at)[key];
    }
    return at;
}

bool is_specular_glossiness(const Json& material) {
    return find(material, {"extensions", "KHR_materials_pbrSpecularGlossiness"}) != nullptr;
}

/// The factor of the workflow that viewers use: the extension's where the material has it.
const Json* factor_of(const Json& material) {
    const Json* factor = is_specular_glossiness(material)
                             ? find(material, {"extensions", "KHR_materials_pbrSpecularGlossiness", "diffuseFactor"})
                             : find(material, {"pbrMetallicRoughness", "baseColorFactor"});
    const bool right = factor && factor->is_array() && factor->size() == 4 &&
                       std::all_of(factor->begin(), factor->end(), [](const Json& v) { return v.is_number(); });
    return right ? factor : nullptr;
}

Json whitened(const Json* factor) {
    const Json alpha = factor && factor->is_array() && factor->size() == 4 ? (*factor)[3] : Json(1);
    return Json::array({1, 1, 1, alpha});
}

}  // namespace

std::array<float, 3> base_color(const Json& json, int material) {
    std::array<float, 3> color{1, 1, 1};
    if (material == none)
        return color;
    if (const Json* factor = factor_of(json["materials"][material]))
        for (int c = 0; c < 3; ++c) color[c] = (*factor)[c].get<float>();
    return color;
}

int normal_map_texcoord(const Json& json, int material) {
    if (material == none)
        return 0;
    const Json* set = find(json["materials"][material], {"normalTexture", "texCoord"});
    if (const Json* moved =
            find(json["materials"][material], {"normalTexture", "extensions", "KHR_texture_transform", "texCoord"}))
        set = moved;
    return set && set->is_number_unsigned() ? set->get<int>() : 0;
}

bool WhiteMaterials::has_color_texture(const Json& json, int material) {
    if (material == none)
        return false;
    const Json& of = json["materials"][material];
    return find(of, {"pbrMetallicRoughness", "baseColorTexture"}) ||
           find(of, {"extensions", "KHR_materials_pbrSpecularGlossiness", "diffuseTexture"});
}

std::size_t WhiteMaterials::copy_of(Json& json, int material) {
    const auto known = copies_.find(material);
    if (known != copies_.end())
        return known->second;
    Json copy;
    if (material == none) {
        copy = {{"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 1}}, {"metallicFactor", 0}}}};
    } else {
        copy = json["materials"][material];
        Json& pbr = copy["pbrMetallicRoughness"];
        if (pbr.is_null())
            pbr = Json::object();
        if (pbr.is_object())
            pbr["baseColorFactor"] = whitened(find(pbr, {"baseColorFactor"}));
        if (is_specular_glossiness(copy)) {
            Json& glossy = copy["extensions"]["KHR_materials_pbrSpecularGlossiness"];
            if (glossy.is_object())
                glossy["diffuseFactor"] = whitened(find(glossy, {"diffuseFactor"}));
        }
    }
    if (!json.contains("materials"))
        json["materials"] = Json::array();
    json["materials"].push_back(std::move(copy));
    return copies_[material] = json["materials"].size() - 1;
}

}  // namespace pvg::gltf
