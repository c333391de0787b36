// The Khronos validator as a test's judge: needs node and the folder PVG_NODE_MODULES.
#pragma once

#include <array>
#include <cstdio>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

namespace pvg::test {

inline bool has_validator() { return std::getenv("PVG_NODE_MODULES") != nullptr; }

/// The validator's errors in the files, one a line; empty where there are none.
inline std::string validator_errors(const std::vector<std::filesystem::path>& files) {
    std::string command = "node \"" PVG_TEST_FOLDER "/validate.mjs\"";
    for (const auto& file : files) command += " \"" + file.string() + "\"";
    FILE* pipe = popen((command + " 2>&1").c_str(), "r");
    if (!pipe)
        return "node cannot be started";
    std::string output;
    std::array<char, 4096> block;
    while (const std::size_t count = fread(block.data(), 1, block.size(), pipe)) output.append(block.data(), count);
    const int status = pclose(pipe);
    return status == 0 ? "" : output.empty() ? "validate.mjs failed" : output;
}

}  // namespace pvg::test
