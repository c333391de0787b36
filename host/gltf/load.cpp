#include "gltf/load.h"

#include <cstring>
#include <map>

#include "gltf/accessor.h"
#include "gltf/files.h"
#include "gltf/glb.h"
#include "gltf/uri.h"

namespace pvg::gltf {
namespace {

/// Bytes of every buffer, cut to byteLength; a placeholder (no URI, not the BIN chunk) stays empty, and so does what lies on
/// another host.
std::vector<Bytes> fetch_buffers(Document& document, std::optional<Bytes> bin, const std::filesystem::path& folder) {
    std::vector<Bytes> bytes;
    std::uint64_t total = 0;
    const Place root = document.root();
    const auto buffers = root.array("buffers");
    if (!buffers)
        return bytes;
    for (std::size_t b = 0; b < buffers->size(); ++b) {
        const Place buffer = buffers->at(b).expect_object();
        const std::uint64_t length = buffer.integer("byteLength", 1, UINT64_MAX);
        Bytes content;
        if (buffer.has("uri") && !is_remote(buffer.text("uri"))) {
            content = fetch(buffer.at("uri"), buffer.text("uri"), folder).bytes;
        } else if (b == 0 && bin && !buffer.has("uri")) {
            content = std::move(*bin);
        } else {
            document.has_data.push_back(0);
            bytes.emplace_back();
            continue;
        }
        if (content.size() < length)
            buffer.at("byteLength")
                .fail(std::to_string(length) + " bytes are declared, " + std::to_string(content.size()) + " are there");
        total += length;
        if (total > INT32_MAX)
            buffer.fail("the buffers have more than " + std::to_string(INT32_MAX) + " bytes together");
        content.resize(static_cast<std::size_t>(length));
        document.has_data.push_back(1);
        bytes.push_back(std::move(content));
    }
    return bytes;
}

std::string format_of(const Bytes& bytes) {
    const auto starts = [&](std::string_view magic, std::size_t at = 0) {
        return bytes.size() >= at + magic.size() && std::memcmp(bytes.data() + at, magic.data(), magic.size()) == 0;
    };
    if (starts("\x89PNG"))
        return "image/png";
    if (starts("\xff\xd8\xff"))
        return "image/jpeg";
    if (starts("RIFF") && starts("WEBP", 8))
        return "image/webp";
    if (starts("\xabKTX 20"))
        return "image/ktx2";
    if (starts("DDS "))
        return "image/vnd-ms.dds";
    if (starts("ftypavif", 4))
        return "image/avif";
    return "";
}

void fetch_images(Document& document, const std::filesystem::path& folder) {
    const Place root = document.root();
    const auto images = root.array("images");
    if (!images)
        return;
    const auto views = root.array("bufferViews");
    std::uint64_t total = 0;
    for (std::size_t i = 0; i < images->size(); ++i) {
        const Place image = images->at(i).expect_object();
        if (image.has("bufferView"))
            (void)image.index("bufferView", views ? views->size() : 0, "buffer views");
        if (!image.has("uri") || is_remote(image.text("uri")))
            continue;
        if (image.has("bufferView"))
            image.fail("has both \"uri\" and \"bufferView\"; one of them is right");
        Resource resource = fetch(image.at("uri"), image.text("uri"), folder);
        total += resource.bytes.size();
        if (total > INT32_MAX)
            image.fail("the images have more than " + std::to_string(INT32_MAX) + " bytes together");
        std::string format = format_of(resource.bytes);
        if (format.empty())
            format = resource.mime_type;
        if (format.empty() && image.has("mimeType"))
            format = image.text("mimeType");
        if (format.empty() && image.text("uri").ends_with(".png"))
            format = "image/png";
        if (format.empty() && image.text("uri").ends_with(".jpg"))
            format = "image/jpeg";
        if (resource.bytes.empty())
            image.at("uri").fail("the image is empty");
        document.images.push_back({i, format, std::move(resource.bytes)});
    }
}

/// What tinygltf gets to see: the parts that were checked, with plain integers, and buffers by number.
Json checked_part(const Document& document) {
    const Json& all = document.json;
    Json part = {{"asset", {{"version", "2.0"}}}};
    const auto copy = [](const Json& from, Json& to, std::initializer_list<const char*> keys) {
        for (const char* key : keys)
            if (from.contains(key))
                to[key] = from[key].is_number_float() ? Json(from[key].get<std::uint64_t>()) : from[key];
    };
    const auto elements = [&](const char* key, auto&& reduce) {
        if (!all.contains(key))
            return;
        part[key] = Json::array();
        for (std::size_t i = 0; i < all[key].size(); ++i) part[key].push_back(reduce(all[key][i], i));
    };
    elements("buffers", [&](const Json& from, std::size_t b) {
        return Json{{"uri", std::to_string(b)},
                    {"byteLength", document.has_data[b] ? from["byteLength"].get<std::uint64_t>() : 1}};
    });
    elements("bufferViews", [&](const Json& from, std::size_t) {
        Json to = Json::object();
        copy(from, to, {"buffer", "byteOffset", "byteLength", "byteStride"});
        return to;
    });
    elements("accessors", [&](const Json& from, std::size_t) {
        Json to = Json::object();
        copy(from, to, {"bufferView", "byteOffset", "componentType", "normalized", "count", "type"});
        if (element_components(from["type"].get<std::string>()) == 0)
            return Json{{"componentType", 5126}, {"count", 1}, {"type", "SCALAR"}};
        if (from.contains("sparse")) {
            to["sparse"]["count"] = from["sparse"]["count"].get<std::uint64_t>();
            for (const char* key : {"indices", "values"}) {
                to["sparse"][key] = Json::object();
                copy(from["sparse"][key], to["sparse"][key], {"bufferView", "byteOffset", "componentType"});
            }
        }
        return to;
    });
    elements("meshes", [&](const Json& from, std::size_t) {
        Json to = {{"primitives", Json::array()}};
        for (const Json& primitive : from["primitives"]) {
            Json reduced = {{"attributes", Json::object()}};
            copy(primitive, reduced, {"mode", "material"});
            // tinygltf refuses indices that are all zero (an accessor without a buffer view); they are read by the document's
            // number.
            for (const auto& [name, accessor] : primitive["attributes"].items())
                reduced["attributes"][name] = accessor.get<std::uint64_t>();
            if (primitive.contains("targets")) {
                reduced["targets"] = Json::array();
                for (const Json& target : primitive["targets"]) {
                    reduced["targets"].push_back(Json::object());
                    for (const auto& [name, accessor] : target.items())
                        reduced["targets"].back()[name] = accessor.get<std::uint64_t>();
                }
            }
            to["primitives"].push_back(std::move(reduced));
        }
        return to;
    });
    return part;
}

void parse_with_tinygltf(Document& document, std::vector<Bytes>& buffers) {
    tinygltf::TinyGLTF parser;
    parser.SetImageLoader(
        [](tinygltf::Image*, const int, std::string*, std::string*, int, int, const unsigned char*, int, void*) { return true; },
        nullptr);
    tinygltf::FsCallbacks files;
    files.FileExists = [](const std::string&, void*) { return true; };
    files.ExpandFilePath = [](const std::string& path, void*) { return path; };
    files.WriteWholeFile = [](std::string*, const std::string&, const std::vector<unsigned char>&, void*) { return false; };
    files.ReadWholeFile = [](std::vector<unsigned char>* out, std::string*, const std::string& path, void* data) {
        Bytes& bytes = (*static_cast<std::vector<Bytes>*>(data))[std::stoul(path.substr(path.find_last_of('/') + 1))];
        if (bytes.empty())
            *out = Bytes(1, 0);
        else
            out->swap(bytes);
        return true;
    };
    files.user_data = &buffers;
    parser.SetFsCallbacks(files);
    const std::string text = checked_part(document).dump();
    if (text.size() > UINT32_MAX)
        throw Error(ErrorKind::bad_input, document.file + ": /: more than 4 GiB of JSON");
    std::string error, warning;
    if (!parser.LoadASCIIFromString(&document.model, &error, &warning, text.data(), static_cast<unsigned>(text.size()), ""))
        throw Error(ErrorKind::bad_input, document.file + ": /: cannot be parsed as glTF: " + error);
    for (std::size_t b = 0; b < document.has_data.size(); ++b)
        if (!document.has_data[b])
            document.model.buffers[b].data.clear();
}

void finish(Document& document, std::optional<Bytes> bin, const std::filesystem::path& folder, Warnings& warnings) {
    const Place root = document.root();
    check_asset(document, warnings);
    std::vector<Bytes> buffers = fetch_buffers(document, std::move(bin), folder);
    check_buffer_views(root);
    check_accessors(root);
    check_meshes(root);
    check_nodes_and_scenes(root);
    fetch_images(document, folder);
    parse_with_tinygltf(document, buffers);
}

}  // namespace

Document load(const std::filesystem::path& file, Warnings& warnings) {
    Document document;
    document.file = file.string();
    const Bytes bytes = read_file(file);
    std::optional<Bytes> bin;
    if (is_glb(bytes) || file.extension() == ".glb" || file.extension() == ".GLB") {
        const GlbChunks chunks = split_glb(document.file, bytes);
        document.binary = true;
        if (chunks.bin)
            bin = Bytes(chunks.bin->begin(), chunks.bin->end());
        document.json = parse_json(document.file, chunks.json);
    } else {
        document.json = parse_json(document.file, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
    }
    finish(document, std::move(bin), file.parent_path(), warnings);
    return document;
}

Document adopt(const std::string& file, Json json, Bytes bin, Warnings& warnings) {
    Document document;
    document.file = file;
    document.json = std::move(json);
    document.binary = true;
    finish(document, std::move(bin), "", warnings);
    return document;
}

}  // namespace pvg::gltf
