// Whole files: read with a check that they are files, written so that a reader only ever sees the old or the new content.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "pvg/status.h"

namespace pvg {

/// Throws Error(bad_input) when it does not exist, is no regular file or cannot be read.
std::vector<unsigned char> read_file(const std::filesystem::path& file);

/// Writes beside `file` under a temporary name that ends in ".pvg-tmp", syncs and renames. A link is followed. Throws
/// Error(output) naming the file and the system's reason; what was there before is then untouched and no temporary file stays.
void write_file_atomically(const std::filesystem::path& file, std::span<const unsigned char> bytes);

}  // namespace pvg
