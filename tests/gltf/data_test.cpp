// Real files: round trips of PVG_TEST_DATA/gltf and meshes, and every file of PVG_TEST_DATA/bad.
#include <algorithm>
#include <map>

#include <gtest/gtest.h>

#include "gltf/fixtures.h"
#include "gltf/validator.h"
#include "mesh/subdivide.h"

namespace pvg::test {
namespace {

std::vector<std::filesystem::path> files_below(const std::filesystem::path& folder, const std::vector<std::string>& endings) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
        if (entry.is_regular_file() && std::find(endings.begin(), endings.end(), entry.path().extension()) != endings.end())
            files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

bool is_draco(const std::filesystem::path& file) { return get(file).find("KHR_draco_mesh_compression") != std::string::npos; }

/// The first mesh, whether or not there are several.
Opened open_first(const std::filesystem::path& file) {
    try {
        return Opened(file);
    } catch (const Error& error) {
        if (std::string(error.what()).find("several meshes") == std::string::npos)
            throw;
        return Opened(file, "0");
    }
}

TEST(Data, RoundTrips) {
    const auto data = folder_from("PVG_TEST_DATA");
    if (data.empty())
        GTEST_SKIP() << "PVG_TEST_DATA is not set";
    Folder folder;
    std::vector<std::filesystem::path> written;
    int read = 0;
    for (const auto& file : files_below(data / "gltf", {".glb", ".gltf"})) {
        SCOPED_TRACE(file);
        if (is_draco(file)) {
            EXPECT_THROW(open_first(file), Error);
            continue;
        }
        ++read;
        Opened opened = open_first(file);
        const std::string stem = std::to_string(read);
        // Nothing decorated: the same mesh comes back, and all JSON but buffers, images and repairs.
        written.push_back(folder / (stem + "-same.glb"));
        opened.write(written.back(), opened.identity());
        std::optional<std::string> select;
        if (json_of(written.back())["meshes"].size() > 1)
            select = "0";
        Opened again(written.back(), select);
        EXPECT_EQ(again.asset.mesh().points, opened.asset.mesh().points);
        EXPECT_EQ(again.asset.mesh().faces, opened.asset.mesh().faces);
        EXPECT_EQ(again.asset.mesh().normals, opened.asset.mesh().normals);
        EXPECT_EQ(again.asset.mesh().colors, opened.asset.mesh().colors);
        // Decorated everywhere, with fields.
        WriteOptions options;
        options.fields = true;
        written.push_back(folder / (stem + "-lifted.glb"));
        opened.write(written.back(), opened.lifted(0.01), options);
        Opened lifted(written.back(), select);
        EXPECT_EQ(lifted.asset.mesh().faces.size(), opened.asset.mesh().faces.size());
        // New vertices everywhere.
        written.push_back(folder / (stem + "-fine.glb"));
        const RefinedSurface fine = subdivide(opened.welded.surface, 1);
        opened.write(written.back(), opened.refined(fine));
        Opened refined(written.back(), select);
        const std::size_t left_out =
            opened.asset.mesh().faces.size() - static_cast<std::size_t>(opened.welded.surface.face_count());
        EXPECT_EQ(refined.asset.mesh().faces.size(), 4 * static_cast<std::size_t>(opened.welded.surface.face_count()) + left_out);
    }
    EXPECT_GT(read, 10);
    if (has_validator()) {
        EXPECT_EQ(validator_errors(written), "");
    }
}

TEST(Data, MeshesOfOtherFormats) {
    const auto data = folder_from("PVG_TEST_DATA");
    if (data.empty())
        GTEST_SKIP() << "PVG_TEST_DATA is not set";
    Folder folder;
    std::vector<std::filesystem::path> written;
    for (const auto& file : files_below(data / "meshes", {".obj"})) {
        SCOPED_TRACE(file);
        Opened opened(file);
        EXPECT_GT(opened.welded.surface.face_count(), 10);
        written.push_back(folder / (file.stem().string() + ".glb"));
        opened.write(written.back(), opened.lifted(0.001));
    }
    EXPECT_GT(written.size(), 5u);
    if (has_validator()) {
        EXPECT_EQ(validator_errors(written), "");
    }
}

TEST(Data, BadFilesAreErrorsWithTheirName) {
    const auto data = folder_from("PVG_TEST_DATA");
    if (data.empty())
        GTEST_SKIP() << "PVG_TEST_DATA is not set";
    Folder folder;
    const Json index = Json::parse(get(data / "bad/khronos/index.json"));
    std::vector<std::filesystem::path> written;
    int refused = 0;
    for (const auto& file : files_below(data / "bad", {".glb", ".gltf"})) {
        SCOPED_TRACE(file);
        try {
            Opened opened = open_first(file);
            if (opened.welded.surface.face_count() == 0)
                continue;
            const auto out = folder / (std::to_string(written.size()) + ".glb");
            opened.write(out, opened.lifted(0.01));
            written.push_back(out);
        } catch (const Error& error) {
            ++refused;
            const std::string what = error.what();
            EXPECT_EQ(error.kind(), ErrorKind::bad_input);
            EXPECT_NE(what.find(file.filename().string()), std::string::npos) << what;
            // A file without errors may only be refused for what it does not have: triangles, or data elsewhere.
            const std::string key = std::filesystem::relative(file, data / "bad/khronos").generic_string();
            if (index.contains(key) && index[key].empty()) {
                bool allowed = false;
                for (const char* reason :
                     {"has no mesh", "has no triangles", "no data here", "No such file", "is no accessor type"})
                    allowed = allowed || what.find(reason) != std::string::npos;
                EXPECT_TRUE(allowed) << what;
            }
        }
    }
    EXPECT_GT(refused, 100);
    EXPECT_GT(written.size(), 5u);
}

}  // namespace
}  // namespace pvg::test
