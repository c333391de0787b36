// Checks of a document's structure, before anything in it is used: glTF 2.0, chapters 3 and 5.
#include <array>
#include <cstdlib>

#include "gltf/accessor.h"
#include "gltf/load.h"

namespace pvg::gltf {
namespace {

/// Extensions that change nothing about how a mesh's triangles are stored; a file may require them.
constexpr std::array known_extensions{"EXT_instance_features",
                                      "EXT_lights_ies",
                                      "EXT_lights_image_based",
                                      "EXT_mesh_features",
                                      "EXT_mesh_gpu_instancing",
                                      "EXT_mesh_manifold",
                                      "EXT_structural_metadata",
                                      "EXT_texture_avif",
                                      "EXT_texture_webp",
                                      "KHR_animation_pointer",
                                      "KHR_audio",
                                      "KHR_lights_punctual",
                                      "KHR_materials_anisotropy",
                                      "KHR_materials_clearcoat",
                                      "KHR_materials_diffuse_transmission",
                                      "KHR_materials_dispersion",
                                      "KHR_materials_emissive_strength",
                                      "KHR_materials_ior",
                                      "KHR_materials_iridescence",
                                      "KHR_materials_pbrSpecularGlossiness",
                                      "KHR_materials_sheen",
                                      "KHR_materials_specular",
                                      "KHR_materials_transmission",
                                      "KHR_materials_unlit",
                                      "KHR_materials_variants",
                                      "KHR_materials_volume",
                                      "KHR_mesh_quantization",
                                      "KHR_node_visibility",
                                      "KHR_texture_basisu",
                                      "KHR_texture_transform",
                                      "KHR_xmp",
                                      "KHR_xmp_json_ld",
                                      "MSFT_lod",
                                      "MSFT_packing_normalRoughnessMetallic",
                                      "MSFT_packing_occlusionRoughnessMetallic",
                                      "MSFT_texture_dds"};

std::size_t size_of(const Place& root, const char* key) {
    const auto array = root.array(key);
    return array ? array->size() : 0;
}

void check_extensions(const Place& root) {
    if (const auto used = root.array("extensionsUsed"))
        for (std::size_t i = 0; i < used->size(); ++i)
            if (!used->at(i).json().is_string())
                used->at(i).fail("expected the name of an extension");
    const auto required = root.array("extensionsRequired");
    if (!required)
        return;
    for (std::size_t i = 0; i < required->size(); ++i) {
        const Place extension = required->at(i);
        if (!extension.json().is_string())
            extension.fail("expected the name of an extension");
        const auto name = extension.json().get<std::string>();
        if (name == "KHR_draco_mesh_compression" || name == "EXT_meshopt_compression" || name == "KHR_meshopt_compression")
            extension.fail("the file is compressed with " + name + ", which cannot be read; store it uncompressed");
        bool known = false;
        for (const char* candidate : known_extensions) known = known || name == candidate;
        if (!known)
            extension.fail("the file requires the extension " + name + ", which is not known; its meshes cannot be read safely");
    }
}

/// (offset + (count - 1) * stride + size <= length) without overflow; the terms are below 2^53.
bool fits(std::uint64_t offset, std::uint64_t count, std::uint64_t stride, std::uint64_t size, std::uint64_t length) {
    if (offset > length || size > length - offset)
        return false;
    return count <= 1 || (count - 1) <= (length - offset - size) / stride;
}

/// A range of elements in a buffer view.
void check_range(const Place& place, const Place& view, std::uint64_t offset, std::uint64_t count, std::uint64_t size,
                 std::uint64_t extent, std::uint64_t alignment) {
    const std::uint64_t length = view.integer("byteLength", 1, UINT64_MAX), stride = view.integer("byteStride", 4, 252, size);
    const std::uint64_t base = view.integer("byteOffset", 0, UINT64_MAX, 0);
    if (stride < size)
        place.fail("elements of " + std::to_string(size) + " bytes do not fit the stride of " + std::to_string(stride) +
                   " bytes of " + view.pointer());
    if (offset % alignment != 0 || (base + offset) % alignment != 0 || stride % alignment != 0)
        place.fail("elements are not aligned: offsets and stride should be multiples of " + std::to_string(alignment));
    if (!fits(offset, count, stride, extent, length))
        place.fail(std::to_string(count) + " elements of " + std::to_string(size) + " bytes from byte " + std::to_string(offset) +
                   " do not fit the " + std::to_string(length) + " bytes of " + view.pointer());
}

void check_accessor(const Place& accessor, const std::optional<Place>& views) {
    const std::size_t view_count = views ? views->size() : 0;
    const std::uint64_t type = accessor.integer("componentType", 0, UINT32_MAX);
    const std::size_t size = component_size(static_cast<int>(type));
    if (size == 0)
        accessor.at("componentType").fail(std::to_string(type) + " is no component type; 5120 to 5123, 5125 and 5126 are");
    const std::uint64_t count = accessor.integer("count", 1, UINT64_MAX);
    const std::string shape = accessor.text("type");
    const std::uint64_t bytes = element_bytes(shape, size);
    // A type of a later version or an extension: nothing of it is known, so nothing that is read may use it.
    if (bytes == 0)
        return;
    if (accessor.boolean("normalized", false) && type != 5120 && type != 5121 && type != 5122 && type != 5123)
        accessor.at("normalized").fail("only 8- and 16-bit integers can be normalized");
    const std::uint64_t offset = accessor.integer("byteOffset", 0, UINT64_MAX, 0);
    if (accessor.has("bufferView"))
        check_range(accessor, views.value_or(accessor).at(accessor.index("bufferView", view_count, "buffer views")), offset,
                    count, bytes, element_extent(shape, size), size);
    else if (offset != 0)
        accessor.at("byteOffset").fail("needs a bufferView");
    for (const char* key : {"min", "max"})
        if (const auto bounds = accessor.array(key)) {
            if (bounds->size() != element_components(shape))
                bounds->fail("expected " + std::to_string(element_components(shape)) + " numbers");
            for (std::size_t k = 0; k < bounds->size(); ++k)
                if (!bounds->at(k).json().is_number())
                    bounds->at(k).fail("expected a number");
        }
    if (const auto sparse = accessor.object("sparse")) {
        const std::uint64_t changed = sparse->integer("count", 1, UINT64_MAX);
        if (changed > count)
            sparse->at("count").fail("more replaced elements (" + std::to_string(changed) + ") than elements (" +
                                     std::to_string(count) + ")");
        for (const char* key : {"indices", "values"}) {
            const auto part = sparse->object(key);
            if (!part)
                sparse->fail("\"" + std::string(key) + "\" is missing");
            const bool indices = key[0] == 'i';
            const std::uint64_t index_type = indices ? part->integer("componentType", 0, UINT32_MAX) : type;
            if (indices && index_type != 5121 && index_type != 5123 && index_type != 5125)
                part->at("componentType").fail("indices are 5121, 5123 or 5125");
            const std::uint64_t width = indices ? component_size(static_cast<int>(index_type)) : bytes;
            const Place view = views.value_or(*part).at(part->index("bufferView", view_count, "buffer views"));
            if (view.has("byteStride"))
                view.at("byteStride").fail("sparse " + std::string(key) + " are packed without a stride");
            check_range(*part, view, part->integer("byteOffset", 0, UINT64_MAX, 0), changed, width,
                        indices ? width : element_extent(shape, size), indices ? width : size);
        }
    }
}

void check_attributes(const Place& attributes, std::size_t accessor_count) {
    attributes.expect_object();
    for (const auto& [name, value] : attributes.json().items()) (void)attributes.index(name.c_str(), accessor_count, "accessors");
}

}  // namespace

void check_asset(const Document& document, Warnings& warnings) {
    const Place root = document.root();
    root.expect_object();
    const auto asset = root.object("asset");
    if (!asset)
        root.fail("\"asset\" is missing: not a glTF file");
    const std::string version = asset->text("version");
    if (version.substr(0, 2) != "2." || version.size() < 3)
        asset->at("version").fail("glTF " + version + ": only glTF 2 can be read");
    if (asset->has("minVersion")) {
        const std::string least = asset->text("minVersion");
        if (least.substr(0, 2) != "2.")
            asset->at("minVersion").fail("the file needs a reader for glTF " + least + "; only glTF 2 can be read");
        const auto minor = [](const std::string& text) { return std::strtol(text.c_str() + 2, nullptr, 10); };
        if (minor(least) > minor(version))
            asset->at("minVersion").fail("greater than the version, " + version);
        if (least != "2.0")
            warnings.push_back(document.file + ": /asset/minVersion: made for readers of glTF " + least + ", read as 2.0");
    }
    check_extensions(root);
    for (const char* key : {"accessors", "animations", "buffers", "bufferViews", "cameras", "images", "materials", "meshes",
                            "nodes", "samplers", "scenes", "skins", "textures"})
        if (const auto array = root.array(key)) {
            if (array->size() == 0)
                array->fail("an empty array; leave it out");
            for (std::size_t i = 0; i < array->size(); ++i) array->at(i).expect_object();
        }
}

void check_buffer_views(const Place& root) {
    const auto views = root.array("bufferViews");
    const auto buffers = root.array("buffers");
    for (std::size_t v = 0; views && v < views->size(); ++v) {
        const Place view = views->at(v);
        const std::size_t buffer = view.index("buffer", buffers ? buffers->size() : 0, "buffers");
        const std::uint64_t length = view.integer("byteLength", 1, UINT64_MAX),
                            offset = view.integer("byteOffset", 0, UINT64_MAX, 0);
        const std::uint64_t capacity = buffers->at(buffer).integer("byteLength", 1, UINT64_MAX);
        if (offset > capacity || length > capacity - offset)
            view.fail(std::to_string(length) + " bytes from byte " + std::to_string(offset) + " do not fit the " +
                      std::to_string(capacity) + " bytes of buffer " + std::to_string(buffer));
        if (view.has("byteStride") && view.integer("byteStride", 4, 252) % 4 != 0)
            view.at("byteStride").fail("expected a multiple of 4");
    }
}

void check_accessors(const Place& root) {
    const auto accessors = root.array("accessors"), views = root.array("bufferViews");
    for (std::size_t a = 0; accessors && a < accessors->size(); ++a) check_accessor(accessors->at(a), views);
}

void check_meshes(const Place& root) {
    const auto meshes = root.array("meshes");
    const std::size_t accessor_count = size_of(root, "accessors"), material_count = size_of(root, "materials");
    for (std::size_t m = 0; meshes && m < meshes->size(); ++m) {
        const Place mesh = meshes->at(m);
        if (mesh.has("name"))
            (void)mesh.text("name");
        const auto primitives = mesh.array("primitives");
        if (!primitives || primitives->size() == 0)
            mesh.fail("\"primitives\" is missing or empty");
        for (std::size_t p = 0; p < primitives->size(); ++p) {
            const Place primitive = primitives->at(p).expect_object();
            const auto attributes = primitive.object("attributes");
            if (!attributes)
                primitive.fail("\"attributes\" is missing");
            check_attributes(*attributes, accessor_count);
            if (primitive.has("indices"))
                (void)primitive.index("indices", accessor_count, "accessors");
            if (primitive.has("material"))
                (void)primitive.index("material", material_count, "materials");
            (void)primitive.integer("mode", 0, 6, 4);
            if (const auto targets = primitive.array("targets"))
                for (std::size_t t = 0; t < targets->size(); ++t) check_attributes(targets->at(t), accessor_count);
        }
    }
}

void check_nodes_and_scenes(const Place& root) {
    const auto nodes = root.array("nodes"), scenes = root.array("scenes");
    const std::size_t node_count = nodes ? nodes->size() : 0;
    std::vector<std::size_t> parent(node_count, node_count);
    for (std::size_t n = 0; n < node_count; ++n) {
        const Place node = nodes->at(n);
        if (node.has("name"))
            (void)node.text("name");
        if (node.has("mesh"))
            (void)node.index("mesh", size_of(root, "meshes"), "meshes");
        if (node.has("skin"))
            (void)node.index("skin", size_of(root, "skins"), "skins");
        const auto children = node.array("children");
        for (std::size_t c = 0; children && c < children->size(); ++c) {
            const Place child = children->at(c);
            const std::uint64_t index = child.integer(0, UINT64_MAX);
            if (index >= node_count)
                child.fail(std::to_string(index) + " is not one of the file's " + std::to_string(node_count) + " nodes");
            if (parent[index] != node_count)
                child.fail("node " + std::to_string(index) + " already has a parent, node " + std::to_string(parent[index]));
            parent[index] = n;
        }
    }
    // With one parent each, a cycle is a walk upwards that comes back; every node is walked over once.
    std::vector<std::size_t> visit(node_count, node_count);
    for (std::size_t n = 0; n < node_count; ++n)
        for (std::size_t at = n; at != node_count && (visit[at] == node_count || visit[at] == n); at = parent[at]) {
            if (visit[at] == n)
                nodes->at(at).fail("the node is its own ancestor");
            visit[at] = n;
        }
    for (std::size_t s = 0; scenes && s < scenes->size(); ++s) {
        const auto members = scenes->at(s).array("nodes");
        for (std::size_t k = 0; members && k < members->size(); ++k)
            if (members->at(k).integer(0, UINT64_MAX) >= node_count)
                members->at(k).fail("is not one of the file's " + std::to_string(node_count) + " nodes");
    }
    if (root.has("scene"))
        (void)root.index("scene", scenes ? scenes->size() : 0, "scenes");
    const auto skins = root.array("skins");
    for (std::size_t s = 0; skins && s < skins->size(); ++s) {
        const auto joints = skins->at(s).array("joints");
        if (!joints || joints->size() == 0)
            skins->at(s).fail("\"joints\" is missing or empty");
        for (std::size_t k = 0; k < joints->size(); ++k)
            if (joints->at(k).integer(0, UINT64_MAX) >= node_count)
                joints->at(k).fail("is not one of the file's " + std::to_string(node_count) + " nodes");
    }
}

}  // namespace pvg::gltf
