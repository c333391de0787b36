// Data flows one way: a stage includes only what stands above it, and the oracle includes nothing that it judges.
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>

#include <gtest/gtest.h>

namespace {

namespace fs = std::filesystem;

const std::vector<std::string> order = {"pvg",   "kernels",       "mesh",   "geodesic", "scene", "curves",
                                        "solve", "cpu_reference", "vulkan", "gltf",     "document", "app"};

int rank(const std::string& stage) {
    for (std::size_t i = 0; i < order.size(); ++i)
        if (order[i] == stage)
            return static_cast<int>(i);
    return -1;
}

std::vector<std::string> included_stages(const fs::path& file) {
    static const std::regex include("^\\s*#\\s*include\\s+\"([^\"/]+)/");
    std::ifstream stream(file);
    std::vector<std::string> stages;
    for (std::string line; std::getline(stream, line);) {
        std::smatch match;
        if (std::regex_search(line, match, include))
            stages.push_back(match[1]);
    }
    return stages;
}

void expect_only_above(const fs::path& folder, const std::string& stage) {
    int files = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        const std::string extension = entry.path().extension();
        if (extension != ".h" && extension != ".cpp")
            continue;
        ++files;
        for (const std::string& included : included_stages(entry.path())) {
            if (rank(included) < 0)
                continue;
            EXPECT_LE(rank(included), rank(stage))
                << entry.path() << " includes " << included << "/, which stands below " << stage;
        }
    }
    EXPECT_GT(files, 0) << folder;
}

TEST(Structure, StagesIncludeOnlyWhatStandsAbove) {
    const fs::path root = PVG_SOURCE_DIR;
    expect_only_above(root / "host/include/pvg", "pvg");
    for (const char* stage : {"mesh", "geodesic", "scene", "curves", "solve", "vulkan", "gltf", "document", "app"})
        expect_only_above(root / "host" / stage, stage);
}

TEST(Structure, ReferenceSharesNoCodeWithWhatItJudges) {
    const fs::path root = PVG_SOURCE_DIR;
    for (const auto& entry : fs::directory_iterator(root / "cpu_reference")) {
        const std::string extension = entry.path().extension();
        if (extension != ".h" && extension != ".cpp")
            continue;
        for (const std::string& included : included_stages(entry.path()))
            EXPECT_TRUE(included == "pvg" || included == "cpu_reference" || included == "kernels")
                << entry.path() << " includes " << included;
    }
}

TEST(Structure, EvaluatorsKnowNothingOfTheBuild) {
    const fs::path root = PVG_SOURCE_DIR;
    for (const auto& entry : fs::directory_iterator(root / "host/vulkan"))
        for (const std::string& included : included_stages(entry.path()))
            EXPECT_TRUE(included == "pvg" || included == "vulkan" || included == "kernels")
                << entry.path() << " includes " << included;
}

}  // namespace
