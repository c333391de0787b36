// Materials of decorated primitives: copies with a white base colour.
#pragma once

#include <array>
#include <map>

#include "gltf/document.h"

namespace pvg::gltf {

/// The base colour factor's RGB of a material (white for none or where it has none).
std::array<float, 3> base_color(const Json& json, int material);
/// The texture coordinate set of a material's normal map (0 where it has none).
int normal_map_texcoord(const Json& json, int material);

/// Gives each material of decorated primitives one white copy.
class WhiteMaterials {
public:
    /// The copy's number in json, made on first use. The factor's alpha stays in the copy, as alpha is not vertices' to change.
    std::size_t copy_of(Json& json, int material);
    /// Whether a material multiplies by a texture.
    static bool has_color_texture(const Json& json, int material);

private:
    std::map<int, std::size_t> copies_;
};

}  // namespace pvg::gltf
