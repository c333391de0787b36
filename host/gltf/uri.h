// URIs of buffers and images: data URIs (RFC 2397, base64 of RFC 4648) and files in the asset's folder (RFC 3986 relative
// references).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "gltf/document.h"

namespace pvg::gltf {

struct Resource {
    Bytes bytes;
    std::string mime_type;  ///< of a data URI, or empty
};

bool is_data_uri(std::string_view uri);
/// Has a scheme (http: ...) that is none of ours: the file may name it, but nothing is fetched.
bool is_remote(std::string_view uri);
/// What the URI at `place` stands for. A file must lie in `folder` after percent-decoding and following links, and be a regular
/// file. Fails at `place` otherwise.
Resource fetch(const Place& place, const std::string& uri, const std::filesystem::path& folder);
std::string to_base64(std::span<const unsigned char> bytes);

}  // namespace pvg::gltf
