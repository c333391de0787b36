// Strict JSON text (RFC 8259) to a document: no comments, no duplicate keys, bounded nesting, numbers that a double holds.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace pvg {

/// Nesting beyond this is an error in every JSON document that is read.
inline constexpr int max_json_depth = 256;

/// Throws Error(bad_input) "NAME: line L, column C: ..." (columns count characters, from 1).
nlohmann::json parse_json_text(std::string_view text, const std::string& name);
/// The whole of a regular file. Throws Error(bad_input) naming it when it is missing, no regular file or unreadable.
std::string read_text_file(const std::filesystem::path& file);

}  // namespace pvg
