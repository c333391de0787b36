// The .glb container: a 12-byte header, a JSON chunk and at most one BIN chunk (glTF 2.0, chapter 4).
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "gltf/document.h"

namespace pvg::gltf {

struct GlbChunks {
    std::string_view json;
    std::optional<std::span<const unsigned char>> bin;  ///< with its padding
};

bool is_glb(std::span<const unsigned char> bytes);
/// Refers to `bytes`. Throws Error(bad_input) naming the byte where the container is broken. Chunks of other kinds are passed
/// over.
GlbChunks split_glb(const std::string& file, std::span<const unsigned char> bytes);
/// json as one line; no BIN chunk where bin is empty. Throws Error(output) past 4 GiB, which a .glb cannot hold.
Bytes join_glb(const Json& json, std::span<const unsigned char> bin);

}  // namespace pvg::gltf
