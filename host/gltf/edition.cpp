#include "gltf/edition.h"

#include <algorithm>
#include <cstring>

#include "gltf/accessor.h"
#include "gltf/glb.h"
#include "gltf/uri.h"

namespace pvg::gltf {
namespace {

void pad(Bytes& bytes) { bytes.resize((bytes.size() + 3) / 4 * 4, 0); }

template <typename T>
void append(Bytes& bytes, T value) {
    const std::size_t at = bytes.size();
    bytes.resize(at + sizeof(T));
    std::memcpy(bytes.data() + at, &value, sizeof(T));
}

void append_component(Bytes& bytes, float value, int type) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
            append(bytes, static_cast<std::int8_t>(value));
            break;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            append(bytes, static_cast<std::uint8_t>(value));
            break;
        case TINYGLTF_COMPONENT_TYPE_SHORT:
            append(bytes, static_cast<std::int16_t>(value));
            break;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            append(bytes, static_cast<std::uint16_t>(value));
            break;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            append(bytes, static_cast<std::uint32_t>(value));
            break;
        default:
            append(bytes, value);
            break;
    }
}

}  // namespace

Edition::Edition(const Document& document) : json(document.json) {
    embed_buffers(document);
    embed_images(document);
}

void Edition::embed_buffers(const Document& document) {
    const std::size_t count = document.has_data.size();
    std::vector<std::size_t> number(count), offset(count, 0);
    Json buffers = Json::array();
    // The BIN chunk's buffer is the first; it takes over the first buffer's own properties where that has data.
    Json first = Json::object();
    if (count > 0 && document.has_data[0]) {
        first = json["buffers"][0];
        first.erase("uri");
    }
    buffers.push_back(first);
    for (std::size_t b = 0; b < count; ++b) {
        const Json& buffer = document.json["buffers"][b];
        const Bytes& data = document.model.buffers[b].data;
        const bool has_own = b > 0 && (buffer.contains("extras") || buffer.contains("extensions"));
        if (document.has_data[b] && !has_own) {
            pad(bin_);
            number[b] = 0;
            offset[b] = bin_.size();
            bin_.insert(bin_.end(), data.begin(), data.end());
            continue;
        }
        // A buffer with extras or extensions stays an object of its own, and so does one without data.
        number[b] = buffers.size();
        buffers.push_back(buffer);
        if (document.has_data[b])
            buffers.back()["uri"] = "data:application/octet-stream;base64," + to_base64(data);
    }
    json["buffers"] = std::move(buffers);
    if (!json.contains("bufferViews"))
        return;
    const auto move_view = [&](Json& view) {
        const auto b = view["buffer"].get<std::size_t>();
        view["buffer"] = number[b];
        if (offset[b] > 0)
            view["byteOffset"] = offset[b] + (view.contains("byteOffset") ? view["byteOffset"].get<std::size_t>() : 0);
    };
    for (Json& view : json["bufferViews"]) {
        move_view(view);
        // A compressed copy of the view's data (optional where the file does not require it) lies in a buffer of its own.
        if (!view.contains("extensions") || !view["extensions"].is_object())
            continue;
        for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
            if (!view["extensions"].contains(name))
                continue;
            Json& compressed = view["extensions"][name];
            if (compressed.is_object() && compressed.contains("buffer") && compressed["buffer"].is_number_unsigned() &&
                compressed["buffer"].get<std::size_t>() < count &&
                (!compressed.contains("byteOffset") || compressed["byteOffset"].is_number_unsigned()))
                move_view(compressed);
        }
    }
}

void Edition::embed_images(const Document& document) {
    for (const ExternalImage& external : document.images) {
        Json& image = json["images"][external.image];
        if (external.mime_type.empty()) {
            // A buffer view would need a format; the bytes still travel with the file.
            image["uri"] = "data:application/octet-stream;base64," + to_base64(external.bytes);
            continue;
        }
        image.erase("uri");
        image["bufferView"] = add_view(external.bytes);
        image["mimeType"] = external.mime_type;
    }
}

std::size_t Edition::add_view(std::span<const unsigned char> bytes, int target, std::size_t stride) {
    pad(bin_);
    Json view = {{"buffer", 0}, {"byteOffset", bin_.size()}, {"byteLength", bytes.size()}};
    if (stride)
        view["byteStride"] = stride;
    if (target)
        view["target"] = target;
    bin_.insert(bin_.end(), bytes.begin(), bytes.end());
    if (!json.contains("bufferViews"))
        json["bufferViews"] = Json::array();
    json["bufferViews"].push_back(std::move(view));
    return json["bufferViews"].size() - 1;
}

std::size_t Edition::add_attribute(std::span<const float> values, const std::string& type, int component_type, bool normalized,
                                   bool bounds) {
    const std::size_t components = element_components(type), count = values.size() / components;
    const std::size_t bytes_per_element = components * component_size(component_type), stride = (bytes_per_element + 3) / 4 * 4;
    Bytes bytes;
    bytes.reserve(count * stride);
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t c = 0; c < components; ++c) append_component(bytes, values[i * components + c], component_type);
        pad(bytes);
    }
    Json accessor = {{"bufferView", add_view(bytes, TINYGLTF_TARGET_ARRAY_BUFFER, stride != bytes_per_element ? stride : 0)},
                     {"componentType", component_type}};
    if (normalized)
        accessor["normalized"] = true;
    accessor["count"] = count;
    accessor["type"] = type;
    if (bounds) {
        for (const bool upper : {false, true}) {
            Json bound = Json::array();
            for (std::size_t c = 0; c < components; ++c) {
                float extreme = values[c];
                for (std::size_t i = 1; i < count; ++i)
                    extreme =
                        upper ? std::max(extreme, values[i * components + c]) : std::min(extreme, values[i * components + c]);
                bound.push_back(static_cast<double>(extreme));
            }
            accessor[upper ? "max" : "min"] = std::move(bound);
        }
    }
    if (!json.contains("accessors"))
        json["accessors"] = Json::array();
    json["accessors"].push_back(std::move(accessor));
    return json["accessors"].size() - 1;
}

std::size_t Edition::add_indices(std::span<const std::uint32_t> indices, std::size_t vertex_count) {
    // 65535 itself would restart a primitive.
    const bool is_short = vertex_count <= 65535;
    Bytes bytes;
    bytes.reserve(indices.size() * (is_short ? 2 : 4));
    for (std::uint32_t index : indices) {
        if (is_short)
            append(bytes, static_cast<std::uint16_t>(index));
        else
            append(bytes, index);
    }
    const int type = is_short ? TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT : TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    const std::size_t view = add_view(bytes, TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
    if (!json.contains("accessors"))
        json["accessors"] = Json::array();
    json["accessors"].push_back({{"bufferView", view}, {"componentType", type}, {"count", indices.size()}, {"type", "SCALAR"}});
    return json["accessors"].size() - 1;
}

Bytes Edition::glb() {
    if (bin_.empty()) {
        // Nothing to put into the first buffer: an input without data, left so.
        if (json["buffers"].size() == 1)
            json.erase("buffers");
    } else {
        json["buffers"][0]["byteLength"] = bin_.size();
    }
    return join_glb(json, bin_);
}

}  // namespace pvg::gltf
