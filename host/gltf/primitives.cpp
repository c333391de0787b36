#include "gltf/primitives.h"

#include <algorithm>
#include <charconv>

#include "gltf/accessor.h"
#include "gltf/materials.h"

namespace pvg::gltf {
namespace {

std::string listed_meshes(const Document& document) {
    const Place meshes = document.root().at("meshes");
    std::string list;
    const std::size_t shown = std::min<std::size_t>(meshes.size(), 20);
    for (std::size_t m = 0; m < shown; ++m)
        list += (m ? ", " : "") + std::to_string(m) + (meshes.at(m).has("name") ? " \"" + meshes.at(m).text("name") + "\"" : "");
    return list + (shown < meshes.size() ? ", ..." : "");
}

bool uses_extension(const Document& document, const char* name) {
    if (const auto used = document.root().array("extensionsUsed"))
        for (const Json& extension : used->json())
            if (extension == name)
                return true;
    return false;
}

/// Accessor formats by semantic: glTF 2.0, 3.7.2.1, and KHR_mesh_quantization.
void check_format(const Place& place, const Attribute& attribute, bool quantized) {
    const std::string& name = attribute.name;
    const int c = attribute.component_type;
    const bool is_float = c == TINYGLTF_COMPONENT_TYPE_FLOAT;
    const bool is_unsigned = c == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || c == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
    const bool is_short = is_unsigned || c == TINYGLTF_COMPONENT_TYPE_BYTE || c == TINYGLTF_COMPONENT_TYPE_SHORT;
    const auto expect = [&](bool right, const char* what) {
        if (!right)
            place.fail("the accessor of " + name + " should be " + what);
    };
    if (name == "POSITION")
        expect(attribute.type == "VEC3" && (is_float || (quantized && is_short)),
               "VEC3 of float (or quantised with KHR_mesh_quantization)");
    else if (name == "NORMAL")
        expect(attribute.type == "VEC3" && (is_float || (quantized && is_short && !is_unsigned && attribute.normalized)),
               "VEC3 of float (or quantised with KHR_mesh_quantization)");
    else if (name == "TANGENT")
        expect(attribute.type == "VEC4" && (is_float || (quantized && is_short && !is_unsigned && attribute.normalized)),
               "VEC4 of float (or quantised with KHR_mesh_quantization)");
    else if (is_set_of(name, "TEXCOORD_"))
        expect(attribute.type == "VEC2" && (is_float || (is_unsigned && attribute.normalized) || (quantized && is_short)),
               "VEC2 of float or normalized unsigned integers");
    else if (is_set_of(name, "COLOR_"))
        expect((attribute.type == "VEC3" || attribute.type == "VEC4") && (is_float || (is_unsigned && attribute.normalized)),
               "VEC3 or VEC4 of float or normalized unsigned integers");
    else if (is_set_of(name, "JOINTS_"))
        expect(attribute.type == "VEC4" && is_unsigned && !attribute.normalized, "VEC4 of unsigned 8- or 16-bit integers");
    else if (is_set_of(name, "WEIGHTS_"))
        expect(attribute.type == "VEC4" && (is_float || (is_unsigned && attribute.normalized)),
               "VEC4 of float or normalized unsigned integers");
    else if (name.empty() || name[0] != '_')
        place.fail("unknown attribute; names of an application's own attributes start with _");
}

/// Numbers that the attributes and morph targets of one mesh may hold together: 2 GB of floats.
constexpr std::uint64_t most_numbers = 500'000'000;

Attribute read_attribute(const Document& document, const Place& place, const std::string& name, std::size_t accessor,
                         std::uint64_t& numbers) {
    const Place declared = document.root().at("accessors").at(accessor);
    Attribute attribute;
    attribute.name = name;
    attribute.type = declared.text("type");
    attribute.component_type = document.model.accessors[accessor].componentType;
    attribute.normalized = document.model.accessors[accessor].normalized;
    attribute.components = element_components(attribute.type);
    const std::uint64_t count = declared.integer("count", 1, UINT64_MAX);
    if (count > most_elements)
        place.fail(std::to_string(count) + " vertices; at most " + std::to_string(most_elements) + " can be decorated");
    numbers += count * attribute.components;
    if (numbers > most_numbers)
        place.fail("the mesh's attributes and morph targets hold more than " + std::to_string(most_numbers) + " numbers");
    attribute.values = read_floats(document, accessor);
    return attribute;
}

/// Sets are numbered from 0 without gaps.
void check_sets(const Place& attributes) {
    for (const auto& [name, value] : attributes.json().items())
        for (const char* semantic : {"TEXCOORD_", "COLOR_", "JOINTS_", "WEIGHTS_"}) {
            if (!is_set_of(name, semantic))
                continue;
            const std::string digits = name.substr(std::string(semantic).size());
            int set = -1;
            const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), set);
            if (error != std::errc() || *end != 0 || set < 0 || std::to_string(set) != digits)
                attributes.at(name.c_str()).fail("expected " + std::string(semantic) + "0, " + semantic + "1, ...");
            if (set > 0 && !attributes.has((semantic + std::to_string(set - 1)).c_str()))
                attributes.at(name.c_str())
                    .fail(std::string(semantic) + std::to_string(set - 1) + " is missing; sets are numbered without gaps");
            const std::string partner = std::string(semantic) == "JOINTS_"    ? "WEIGHTS_" + digits
                                        : std::string(semantic) == "WEIGHTS_" ? "JOINTS_" + digits
                                                                              : "";
            if (!partner.empty() && !attributes.has(partner.c_str()))
                attributes.at(name.c_str()).fail(partner + " is missing");
        }
}

/// Textures and texture coordinates that a material refers to: it will be copied, and a copy must not repeat an error.
void check_textures(const Place& place, std::size_t texture_count, std::size_t texcoord_count) {
    if (place.json().is_object()) {
        for (const auto& [key, value] : place.json().items())
            if (key != "extras") {
                const Place member = place.at(key.c_str());
                if (key.ends_with("Texture") && value.is_object()) {
                    (void)member.index("index", texture_count, "textures");
                    std::uint64_t set = member.integer("texCoord", 0, UINT64_MAX, 0);
                    if (const auto extensions = member.object("extensions"))
                        if (const auto transform = extensions->object("KHR_texture_transform"))
                            set = transform->integer("texCoord", 0, UINT64_MAX, set);
                    if (set >= texcoord_count)
                        member.fail("wants TEXCOORD_" + std::to_string(set) + ", which the primitive does not have");
                }
                check_textures(member, texture_count, texcoord_count);
            }
    } else if (place.json().is_array()) {
        for (std::size_t i = 0; i < place.size(); ++i) check_textures(place.at(i), texture_count, texcoord_count);
    }
}

std::vector<Face> triangles_of(const std::vector<std::uint32_t>& index, int mode) {
    std::vector<Face> faces;
    const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
        faces.push_back({static_cast<int>(index[a]), static_cast<int>(index[b]), static_cast<int>(index[c])});
    };
    if (mode == TINYGLTF_MODE_TRIANGLES)
        for (std::size_t i = 0; i + 2 < index.size(); i += 3) add(i, i + 1, i + 2);
    else if (mode == TINYGLTF_MODE_TRIANGLE_STRIP)
        for (std::size_t i = 0; i + 2 < index.size(); ++i) add(i, i + 1 + i % 2, i + 2 - i % 2);
    else
        for (std::size_t i = 0; i + 2 < index.size(); ++i) add(i + 1, i + 2, 0);
    return faces;
}

RawPrimitive read_primitive(const Document& document, const Place& place, const tinygltf::Primitive& primitive,
                            std::uint64_t& numbers) {
    RawPrimitive raw;
    raw.material = primitive.material;
    const bool quantized = uses_extension(document, "KHR_mesh_quantization");
    const Place attributes = place.at("attributes");
    check_sets(attributes);
    for (const auto& [name, value] : attributes.json().items()) {
        raw.attributes.push_back(read_attribute(document, attributes.at(name.c_str()), name,
                                                static_cast<std::size_t>(primitive.attributes.at(name)), numbers));
        check_format(attributes.at(name.c_str()), raw.attributes.back(), quantized);
    }
    const Attribute& position = *raw.find("POSITION");
    if (const auto extensions = place.object("extensions"))
        if (extensions->has("KHR_draco_mesh_compression") &&
            document.model.accessors[static_cast<std::size_t>(primitive.attributes.at("POSITION"))].bufferView < 0)
            extensions->at("KHR_draco_mesh_compression")
                .fail("the primitive is compressed, which cannot be read; store it uncompressed");
    raw.vertex_count = position.values.size() / 3;
    for (const Attribute& attribute : raw.attributes)
        if (attribute.values.size() / attribute.components != raw.vertex_count)
            attributes.at(attribute.name.c_str())
                .fail(std::to_string(attribute.values.size() / attribute.components) + " elements, POSITION has " +
                      std::to_string(raw.vertex_count));
    for (std::size_t t = 0; t < primitive.targets.size(); ++t) {
        const Place target = place.at("targets").at(t);
        std::vector<Attribute> deltas;
        for (const auto& [name, value] : target.json().items()) {
            const Place where = target.at(name.c_str());
            const Attribute* base = raw.find(name);
            if (!base)
                where.fail("the primitive has no " + name + " for the morph target to change");
            Attribute delta =
                read_attribute(document, where, name, static_cast<std::size_t>(primitive.targets[t].at(name)), numbers);
            if (delta.values.size() / std::max<std::size_t>(1, delta.components) != raw.vertex_count)
                where.fail("expected " + std::to_string(raw.vertex_count) + " elements, as many as POSITION has");
            if (name == "POSITION" || name == "NORMAL" || name == "TANGENT") {
                if (delta.type != "VEC3")
                    where.fail("a morph target's " + name + " should be VEC3");
            } else if (delta.components != base->components) {
                where.fail("expected " + base->type + " as in the primitive");
            }
            deltas.push_back(std::move(delta));
        }
        raw.targets.push_back(std::move(deltas));
    }
    return raw;
}

}  // namespace

const Attribute* RawPrimitive::find(const std::string& name) const {
    for (const Attribute& attribute : attributes)
        if (attribute.name == name)
            return &attribute;
    return nullptr;
}

bool is_set_of(const std::string& name, const char* semantic) { return name.rfind(semantic, 0) == 0; }

std::size_t select_mesh(const Document& document, const std::optional<std::string>& select) {
    const Place root = document.root();
    const auto meshes = root.array("meshes");
    if (!meshes)
        root.fail("the file has no mesh");
    if (!select) {
        if (meshes->size() > 1)
            meshes->fail("the file has several meshes; select one of " + listed_meshes(document));
        return 0;
    }
    std::vector<std::size_t> found;
    for (std::size_t m = 0; m < meshes->size(); ++m)
        if (meshes->at(m).has("name") && meshes->at(m).text("name") == *select)
            found.push_back(m);
    if (found.empty())
        if (const auto nodes = root.array("nodes"))
            for (std::size_t n = 0; n < nodes->size(); ++n) {
                const Place node = nodes->at(n);
                if (!node.has("name") || node.text("name") != *select || !node.has("mesh"))
                    continue;
                const std::size_t mesh = node.index("mesh", meshes->size(), "meshes");
                if (std::find(found.begin(), found.end(), mesh) == found.end())
                    found.push_back(mesh);
            }
    if (found.size() > 1)
        meshes->fail("\"" + *select + "\" names " + std::to_string(found.size()) +
                     " meshes; select by index: " + listed_meshes(document));
    if (found.size() == 1)
        return found[0];
    std::size_t index = 0;
    const auto [end, error] = std::from_chars(select->data(), select->data() + select->size(), index);
    if (error != std::errc() || end != select->data() + select->size() || index >= meshes->size())
        meshes->fail("no mesh or node with a mesh is called \"" + *select + "\"; the file has " + listed_meshes(document));
    return index;
}

std::vector<RawPrimitive> read_primitives(const Document& document, std::size_t mesh_index, RawMesh& raw, Warnings& warnings) {
    const Place root = document.root(), mesh = root.at("meshes").at(mesh_index), primitives = mesh.at("primitives");
    raw.name = mesh.has("name") ? mesh.text("name") : "";
    std::vector<RawPrimitive> result;
    std::uint64_t numbers = 0;
    bool normals = true;
    for (std::size_t p = 0; p < primitives.size(); ++p) {
        const Place place = primitives.at(p);
        const tinygltf::Primitive& parsed = document.model.meshes[mesh_index].primitives[p];
        const int mode = parsed.mode < 0 ? TINYGLTF_MODE_TRIANGLES : parsed.mode;
        if (mode < TINYGLTF_MODE_TRIANGLES)
            continue;
        if (!place.at("attributes").has("POSITION")) {
            warnings.push_back(document.file + ": " + place.pointer() + ": has no POSITION; left as found");
            continue;
        }
        RawPrimitive primitive = read_primitive(document, place, parsed, numbers);
        primitive.number = p;
        if (!result.empty() && primitive.targets.size() != result[0].targets.size())
            place.fail(std::to_string(primitive.targets.size()) + " morph targets, primitive " +
                       std::to_string(result[0].number) + " has " + std::to_string(result[0].targets.size()));
        if (primitive.material != none) {
            const auto textures = root.array("textures");
            std::size_t sets = 0;
            while (primitive.find("TEXCOORD_" + std::to_string(sets))) ++sets;
            check_textures(root.at("materials").at(static_cast<std::size_t>(primitive.material)), textures ? textures->size() : 0,
                           sets);
        }
        std::vector<std::uint32_t> indices;
        if (place.has("indices")) {
            indices = read_indices(document, static_cast<std::size_t>(place.at("indices").integer(0, UINT64_MAX)),
                                   primitive.vertex_count);
        } else {
            indices.resize(primitive.vertex_count);
            for (std::size_t i = 0; i < indices.size(); ++i) indices[i] = static_cast<std::uint32_t>(i);
        }
        const std::vector<Face> faces = triangles_of(indices, mode);
        primitive.first_vertex = raw.points.size();
        primitive.first_face = raw.faces.size();
        primitive.face_count = faces.size();
        if (raw.points.size() + primitive.vertex_count > most_elements || raw.faces.size() + faces.size() > most_elements)
            mesh.fail("more than " + std::to_string(most_elements) +
                      " vertices or triangles: " + std::to_string(raw.points.size() + primitive.vertex_count) + " vertices, " +
                      std::to_string(raw.faces.size() + faces.size()) + " triangles up to primitive " + std::to_string(p));
        const Attribute &position = *primitive.find("POSITION"), *normal = primitive.find("NORMAL"),
                        *color = primitive.find("COLOR_0");
        const std::array<float, 3> factor = base_color(document.json, primitive.material);
        for (std::size_t v = 0; v < primitive.vertex_count; ++v) {
            const float* at = position.at(v);
            raw.points.push_back({at[0], at[1], at[2]});
            std::array<float, 4> rgba{1, 1, 1, 1};
            if (color)
                std::copy_n(color->at(v), color->components, rgba.begin());
            raw.colors.push_back(rgba);
            raw.base_colors.push_back(factor);
            if (normal && normals)
                raw.normals.push_back({normal->at(v)[0], normal->at(v)[1], normal->at(v)[2]});
        }
        normals = normals && normal;
        const int first = static_cast<int>(primitive.first_vertex);
        for (const Face& face : faces) raw.faces.push_back({face[0] + first, face[1] + first, face[2] + first});
        raw.face_primitive.insert(raw.face_primitive.end(), faces.size(), static_cast<int>(p));
        result.push_back(std::move(primitive));
    }
    if (!normals)
        raw.normals.clear();
    if (raw.faces.empty())
        mesh.fail("the mesh has no triangles");
    return result;
}

}  // namespace pvg::gltf
