// A glTF document as it stands in the file: its JSON with the order of keys kept, its buffers byte for byte, and cursors into the
// JSON that check every number before it is used and name file and place when it is wrong.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>
#include <tiny_gltf.h>

#include "pvg/status.h"

namespace pvg::gltf {

using Json = nlohmann::ordered_json;
using Bytes = std::vector<unsigned char>;

/// JSON may nest this deep; deeper documents would overflow the stack of whoever walks them.
inline constexpr int deepest_json = 256;
/// Members that one JSON object may have: they are looked up one by one, in the order of the file.
inline constexpr std::size_t most_members = 32768;
/// Elements of an accessor that has no buffer view, and so costs the file nothing.
inline constexpr std::uint64_t most_zeros = 4'000'000;
/// Vertices and triangles of one mesh may number this many.
inline constexpr std::uint64_t most_elements = 50'000'000;

/// A value of a JSON document with its file and JSON pointer, for messages. Refers to the document.
class Place {
public:
    Place(const std::string& file, const Json& json) : file_(&file), json_(&json) {}

    const Json& json() const { return *json_; }
    const std::string& pointer() const { return pointer_; }
    /// Throws Error(bad_input) "FILE: POINTER: what".
    [[noreturn]] void fail(const std::string& what) const;

    bool has(const char* key) const { return json_->is_object() && json_->contains(key); }
    std::size_t size() const { return json_->size(); }
    /// A member or element that is known to be there.
    Place at(const char* key) const;
    Place at(std::size_t index) const;
    /// A member that must be an object (array); fails otherwise. The optional forms: std::nullopt where it is missing.
    std::optional<Place> object(const char* key) const;
    std::optional<Place> array(const char* key) const;
    const Place& expect_object() const;
    /// An integer in [least, most]; numbers like 3.0 count as integers.
    std::uint64_t integer(const char* key, std::uint64_t least, std::uint64_t most) const;
    std::uint64_t integer(const char* key, std::uint64_t least, std::uint64_t most, std::uint64_t otherwise) const;
    std::uint64_t integer(std::uint64_t least, std::uint64_t most) const;
    /// An index into something with `count` elements; `what` names it in the message.
    std::size_t index(const char* key, std::size_t count, const char* what) const;
    std::string text(const char* key) const;
    bool boolean(const char* key, bool otherwise) const;

private:
    const std::string* file_;
    const Json* json_;
    std::string pointer_;
};

/// An image that the document names by URI, with what it needs to become a buffer view.
struct ExternalImage {
    std::size_t image = 0;
    std::string mime_type;  ///< empty where the bytes are of no known format
    Bytes bytes;
};

/// A checked document. Buffer b's bytes are model.buffers[b].data, exactly byteLength long, or empty for a placeholder (has_data
/// 0). The model holds only buffers, bufferViews, accessors and meshes, with the document's indices; all its offsets and counts
/// are in range.
struct Document {
    std::string file;
    Json json;
    bool binary = false;  ///< a .glb
    tinygltf::Model model;
    std::vector<char> has_data;
    std::vector<ExternalImage> images;

    Place root() const { return Place(file, json); }
};

/// Parses JSON text; throws Error(bad_input) for a syntax error, invalid UTF-8, a byte order mark or nesting beyond deepest_json.
Json parse_json(const std::string& file, std::string_view text);

}  // namespace pvg::gltf
