// Runs the pvg command as a user does: arguments in, exit code, stdout and stderr out.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace pvg::test {

namespace fs = std::filesystem;

struct Outcome {
    int exit = -1;
    std::string out, err;
};

inline std::string read_all(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

inline void write_all(const fs::path& file, const std::string& text) { std::ofstream(file, std::ios::binary) << text; }

inline std::string quoted(const std::string& text) {
    std::string result = "'";
    for (char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return result + "'";
}

/// A fresh folder per test, removed afterwards.
class CommandTest : public testing::Test {
protected:
    void SetUp() override {
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        folder = fs::temp_directory_path() / ("pvg-" + std::to_string(getpid()) + "-" + test->name());
        fs::remove_all(folder);
        fs::create_directories(folder);
    }
    void TearDown() override {
        std::error_code ignored;
        fs::remove_all(folder, ignored);
    }

    /// Runs `pvg ARGUMENTS` (a shell line) in the folder, with `environment` before it ("NAME=value ...").
    Outcome pvg(const std::string& arguments, const std::string& environment = "") const {
        const std::string line = "cd " + quoted(folder.string()) + " && " + environment + " timeout 300 " + quoted(PVG_TOOL) +
                                 " " + arguments + " >.out 2>.err </dev/null";
        const int status = std::system(line.c_str());
        Outcome outcome;
        outcome.exit = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
        outcome.out = read_all(folder / ".out");
        outcome.err = read_all(folder / ".err");
        return outcome;
    }

    fs::path folder;
};

}  // namespace pvg::test
