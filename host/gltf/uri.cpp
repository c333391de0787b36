#include "gltf/uri.h"

#include <algorithm>
#include <span>

#include "gltf/files.h"

namespace pvg::gltf {
namespace {

int hexadecimal(char c) {
    if (c >= '0' && c <= '9')
        return c - '0';
    if (c >= 'a' && c <= 'f')
        return c - 'a' + 10;
    if (c >= 'A' && c <= 'F')
        return c - 'A' + 10;
    return -1;
}

std::string percent_decoded(const Place& place, std::string_view uri) {
    std::string result;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        if (uri[i] != '%') {
            result += uri[i];
            continue;
        }
        const int high = i + 2 < uri.size() ? hexadecimal(uri[i + 1]) : -1,
                  low = i + 2 < uri.size() ? hexadecimal(uri[i + 2]) : -1;
        if (high < 0 || low < 0)
            place.fail("'%' should be followed by two hexadecimal digits");
        result += static_cast<char>(high * 16 + low);
        i += 2;
    }
    return result;
}

int base64_digit(char c) {
    if (c >= 'A' && c <= 'Z')
        return c - 'A';
    if (c >= 'a' && c <= 'z')
        return c - 'a' + 26;
    if (c >= '0' && c <= '9')
        return c - '0' + 52;
    if (c == '+')
        return 62;
    if (c == '/')
        return 63;
    return -1;
}

Bytes from_base64(const Place& place, std::string_view text) {
    while (!text.empty() && text.back() == '=') text.remove_suffix(1);
    if (text.size() % 4 == 1)
        place.fail("the data URI's base64 is cut off");
    Bytes bytes;
    bytes.reserve(text.size() * 3 / 4);
    std::uint32_t word = 0;
    int bits = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const int digit = base64_digit(text[i]);
        if (digit < 0)
            place.fail("the data URI's base64 has a character that is none at position " + std::to_string(i));
        word = word << 6 | static_cast<std::uint32_t>(digit);
        bits += 6;
        if (bits >= 8) {
            bits -= 8;
            bytes.push_back(static_cast<unsigned char>(word >> bits));
        }
    }
    return bytes;
}

bool has_scheme(std::string_view uri) {
    const auto colon = uri.find(':');
    return colon != std::string_view::npos && uri.find_first_of("/?#") > colon;
}

}  // namespace

bool is_data_uri(std::string_view uri) { return uri.substr(0, 5) == "data:"; }

bool is_remote(std::string_view uri) { return has_scheme(uri) && !is_data_uri(uri); }

Resource fetch(const Place& place, const std::string& uri, const std::filesystem::path& folder) {
    if (is_data_uri(uri)) {
        const auto comma = uri.find(',');
        if (comma == std::string::npos)
            place.fail("a data URI has a comma before its data");
        const std::string_view header = std::string_view(uri).substr(5, comma - 5);
        constexpr std::string_view base64 = ";base64";
        const std::string mime_type(header.substr(0, header.find(';')));
        const std::string_view data = std::string_view(uri).substr(comma + 1);
        if (header.ends_with(base64))
            return {from_base64(place, data), mime_type};
        const std::string text = percent_decoded(place, data);
        return {Bytes(text.begin(), text.end()), mime_type};
    }
    if (uri.empty())
        place.fail("the URI is empty");
    if (has_scheme(uri))
        place.fail("only files in the asset's folder and data URIs can be read, found " + uri.substr(0, 80));
    const std::string decoded = percent_decoded(place, uri);
    if (decoded.find('\0') != std::string::npos)
        place.fail("the URI holds a zero byte");
    if (decoded.front() == '/' || decoded.find('\\') != std::string::npos)
        place.fail("expected a URI relative to the asset's folder, found " + uri.substr(0, 80));
    const auto plain = std::filesystem::path(decoded).lexically_normal();
    if (*plain.begin() == "..")
        place.fail("a URI may not lead out of the asset's folder, found " + uri.substr(0, 80));
    std::error_code error;
    const auto base = std::filesystem::canonical(folder.empty() ? std::filesystem::path(".") : folder, error);
    if (error)
        place.fail("the asset's folder cannot be resolved: " + error.message());
    const auto file = std::filesystem::canonical(base / decoded, error);
    if (error)
        place.fail(uri.substr(0, 80) + " cannot be read: " + error.message());
    if (std::mismatch(base.begin(), base.end(), file.begin(), file.end()).first != base.end())
        place.fail(uri.substr(0, 80) + " leads out of the asset's folder through a link");
    try {
        return {read_file(file), ""};
    } catch (const Error& refused) {
        place.fail(refused.what());
    }
}

std::string to_base64(std::span<const unsigned char> bytes) {
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t rest = std::min<std::size_t>(3, bytes.size() - i);
        std::uint32_t word = 0;
        for (std::size_t k = 0; k < 3; ++k) word = word << 8 | (k < rest ? bytes[i + k] : 0u);
        for (std::size_t k = 0; k < 4; ++k) text += k <= rest ? digits[word >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

}  // namespace pvg::gltf
