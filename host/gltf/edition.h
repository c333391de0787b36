// An edition of a document for writing as one .glb: the input's JSON, all its buffers joined into the BIN chunk, images embedded,
// and what is appended.
#pragma once

#include <span>

#include "gltf/document.h"

namespace pvg::gltf {

class Edition {
public:
    /// Copies the JSON and the buffers; buffer views move with their bytes, images by URI become buffer views.
    explicit Edition(const Document& document);

    Json json;

    /// Appends bytes at a multiple of 4; returns the buffer view. target and stride are left out where 0.
    std::size_t add_view(std::span<const unsigned char> bytes, int target = 0, std::size_t stride = 0);
    /// Appends values as an accessor of the given component type; returns it. bounds: with min and max. Integer elements are
    /// padded to 4 bytes.
    std::size_t add_attribute(std::span<const float> values, const std::string& type, int component_type, bool normalized,
                              bool bounds);
    /// Appends indices as 16 or 32 bits, by the number of vertices.
    std::size_t add_indices(std::span<const std::uint32_t> indices, std::size_t vertex_count);
    /// The finished file.
    Bytes glb();

private:
    void embed_buffers(const Document& document);
    void embed_images(const Document& document);

    Bytes bin_;
};

}  // namespace pvg::gltf
