#include "gltf/glb.h"

#include <cstring>

namespace pvg::gltf {
namespace {

constexpr std::uint32_t magic = 0x46546C67, json_type = 0x4E4F534A, bin_type = 0x004E4942;

std::uint32_t word(std::span<const unsigned char> bytes, std::size_t at) {
    return bytes[at] | bytes[at + 1] << 8 | bytes[at + 2] << 16 | static_cast<std::uint32_t>(bytes[at + 3]) << 24;
}

void put_word(Bytes& out, std::uint64_t value) {
    for (int shift = 0; shift < 32; shift += 8) out.push_back(static_cast<unsigned char>(value >> shift));
}

}  // namespace

bool is_glb(std::span<const unsigned char> bytes) { return bytes.size() >= 4 && word(bytes, 0) == magic; }

GlbChunks split_glb(const std::string& file, std::span<const unsigned char> bytes) {
    const auto fail = [&] [[noreturn]] (std::size_t at, const std::string& what) {
        throw Error(ErrorKind::bad_input, file + ": byte " + std::to_string(at) + ": " + what);
    };
    if (bytes.size() < 12)
        fail(bytes.size(), "a .glb starts with 12 bytes of header, the file ends before");
    if (word(bytes, 0) != magic)
        fail(0, "not a .glb: it should start with \"glTF\"");
    if (word(bytes, 4) != 2)
        fail(4, "container version " + std::to_string(word(bytes, 4)) + ": only version 2 can be read");
    const std::uint64_t length = word(bytes, 8);
    if (length > bytes.size())
        fail(8, "the header says " + std::to_string(length) + " bytes, the file has " + std::to_string(bytes.size()));
    if (length < 20)
        fail(8, "the header says " + std::to_string(length) + " bytes; the smallest .glb has 20");
    GlbChunks chunks;
    bool first = true;
    for (std::uint64_t at = 12; at < length; first = false) {
        if (length - at < 8)
            fail(at, "a chunk header needs 8 bytes, the file ends before");
        const std::uint64_t size = word(bytes, at);
        const std::uint32_t type = word(bytes, at + 4);
        if (size % 4 != 0)
            fail(at, "a chunk of " + std::to_string(size) + " bytes: chunks are padded to multiples of 4");
        if (size > length - at - 8)
            fail(at, "a chunk of " + std::to_string(size) + " bytes, the file has " + std::to_string(length - at - 8) + " left");
        const auto content = bytes.subspan(at + 8, size);
        if (first) {
            if (type != json_type)
                fail(at + 4, "the first chunk should be JSON");
            if (size == 0)
                fail(at, "the JSON chunk is empty");
            chunks.json = std::string_view(reinterpret_cast<const char*>(content.data()), content.size());
        } else if (type == json_type) {
            fail(at + 4, "a second JSON chunk");
        } else if (type == bin_type) {
            if (chunks.bin)
                fail(at + 4, "a second BIN chunk");
            chunks.bin = content;
        }
        at += 8 + size;
    }
    return chunks;
}

Bytes join_glb(const Json& json, std::span<const unsigned char> bin) {
    std::string text = json.dump();
    while (text.size() % 4 != 0) text.push_back(' ');
    const std::uint64_t padded = (bin.size() + 3) / 4 * 4;
    const std::uint64_t length = 12 + 8 + text.size() + (bin.empty() ? 0 : 8 + padded);
    if (length > UINT32_MAX)
        throw Error(ErrorKind::output, "the result has " + std::to_string(length) + " bytes; a .glb holds at most 4294967295");
    Bytes out;
    out.reserve(length);
    put_word(out, magic);
    put_word(out, 2);
    put_word(out, length);
    put_word(out, text.size());
    put_word(out, json_type);
    out.insert(out.end(), text.begin(), text.end());
    if (!bin.empty()) {
        put_word(out, padded);
        put_word(out, bin_type);
        out.insert(out.end(), bin.begin(), bin.end());
        out.resize(length, 0);
    }
    return out;
}

}  // namespace pvg::gltf
