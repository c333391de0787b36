// .obj, .off and .ply, what `pvg make` writes, and atomic writing.
#include <cstring>

#include <sys/stat.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "gltf/fixtures.h"
#include "gltf/import_mesh.h"
#include "gltf/validator.h"

namespace pvg::test {
namespace {

RawMesh read(const std::filesystem::path& file) {
    Warnings warnings;
    return MeshAsset::read(file, std::nullopt, warnings).mesh();
}

void expect_refused(const Folder& folder, const std::string& name, const std::string& text, const std::string& word) {
    put(folder / name, text);
    try {
        read(folder / name);
        ADD_FAILURE() << "read: " << text;
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::bad_input);
        EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
        EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << word << " is not in: " << error.what();
    }
}

TEST(Import, ObjWithEveryFormOfCorner) {
    Folder folder;
    put(folder / "a.obj",
        "# a square and two triangles\no thing\nv 0 0 0\nv 1 0 0 \nv 1 1 0\nv 0 1 0\nvt 0.25 0.25\nvn 0 0 2\r\n"
        "f 1/1/1 2/1/1 3/1/1 4/1/1\nf -4//1 -3//-1 -2//1\nf 1 2 \\\n 3\ns off\nusemtl x\n");
    const RawMesh raw = read(folder / "a.obj");
    EXPECT_EQ(raw.name, "a");
    ASSERT_EQ(raw.faces.size(), 4u);
    EXPECT_EQ(raw.faces[0], (Face{0, 1, 2}));
    EXPECT_EQ(raw.faces[1], (Face{0, 2, 3}));
    EXPECT_EQ(raw.points.size(), 10u) << "corners with other texture coordinates or normals are other vertices";
    EXPECT_EQ(raw.points[raw.faces[2][1]], Point(1, 0, 0));
    EXPECT_TRUE(raw.normals.empty()) << "not every corner has one";
}

TEST(Import, ObjTextureCoordinatesTurnOver) {
    Folder folder;
    put(folder / "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0.25\nvn 0 0 3\nf 1/1/1 2/1/1 3/1/1\n");
    Opened opened(folder / "a.obj");
    opened.write(folder / "out.glb", opened.identity());
    const Json json = json_of(folder / "out.glb");
    const Json& attributes = json["meshes"][0]["primitives"][0]["attributes"];
    EXPECT_EQ(values_of<float>(folder / "out.glb", attributes["TEXCOORD_0"].get<std::size_t>())[1], 0.75f);
    EXPECT_EQ(values_of<float>(folder / "out.glb", attributes["NORMAL"].get<std::size_t>())[2], 1.0f);
}

TEST(Import, BadObj) {
    Folder folder;
    expect_refused(folder, "a.obj", "v 0 0\n", "line 1");
    expect_refused(folder, "a.obj", "v 0 0 x\n", "line 1");
    expect_refused(folder, "a.obj", "v 0 0 nan\n", "finite");
    expect_refused(folder, "a.obj", "v 0 0 1e300\n", "finite");
    expect_refused(folder, "a.obj", "v 0 0 0\nv 0 1 0\nv 1 0 0\nf 1 2 4\n", "line 4");
    expect_refused(folder, "a.obj", "v 0 0 0\nv 0 1 0\nv 1 0 0\nf 1 2 0\n", "line 4");
    expect_refused(folder, "a.obj", "v 0 0 0\nv 0 1 0\nv 1 0 0\nf 1 2 -4\n", "line 4");
    expect_refused(folder, "a.obj", "v 0 0 0\nv 0 1 0\nv 1 0 0\nf 1/1 2/1 3/1\n", "texture");
    expect_refused(folder, "a.obj", "v 0 0 0\nv 0 1 0\nv 1 0 0\nf 1 2\n", "three corners");
    expect_refused(folder, "a.obj", "v 0 0 0\nf 99999999999999999999 1 1\n", "integer");
    expect_refused(folder, "a.obj", "", "no faces");
    expect_refused(folder, "a.obj", "\\\n\\\n", "no faces");
}

TEST(Import, Off) {
    Folder folder;
    put(folder / "a.off", "OFF # comment\n4 2 0\n0 0 0\n1 0 0\n\n1 1 0\n0 1 0\n4 0 1 2 3 255 0 0\n3 0 1 2\n");
    EXPECT_EQ(read(folder / "a.off").faces.size(), 3u);
    put(folder / "b.off", "COFF 3 1 0\n0 0 0 255 0 0 255\n1 0 0 0 255 0 255\n0 1 0 0 0 255 128\n3 0 1 2\n");
    const RawMesh colored = read(folder / "b.off");
    EXPECT_EQ(colored.colors[1], (std::array<float, 4>{0, 1, 0, 1}));
    EXPECT_NEAR(colored.colors[2][3], 128 / 255.0, 1e-5);  // stored in 16 bits
    expect_refused(folder, "c.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n", "ends after 2");
    expect_refused(folder, "c.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "vertex 3");
    expect_refused(folder, "c.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4 0 1 2\n", "4 corners");
    expect_refused(folder, "c.off", "OFF\n2000000000 2000000000 0\n", "do not fit");
    expect_refused(folder, "c.off", "PLY\n", "OFF");
    expect_refused(folder, "c.off", "", "empty");
}

TEST(Import, PlyInThreeFormatsIsTheSame) {
    Folder folder;
    const std::string body =
        "element vertex 4\nproperty double x\nproperty float y\nproperty short z\nproperty uchar red\nproperty uchar "
        "green\nproperty uchar blue\n"
        "element edge 1\nproperty int a\nelement face 2\nproperty uchar flags\nproperty list uchar uint "
        "vertex_indices\nend_header\n";
    const std::array<std::array<double, 3>, 4> points{{{0, 0, 0}, {1.5, 0, 0}, {1, 1, -3}, {0, 1, 7}}};
    std::string ascii = "ply\nformat ascii 1.0\ncomment end_header comes later\n" + body,
                little = "ply\nformat binary_little_endian 1.0\n" + body, big = "ply\nformat binary_big_endian 1.0\n" + body;
    const auto put_number = [&](auto value) {
        std::string bytes(reinterpret_cast<const char*>(&value), sizeof(value));
        little += bytes;
        big += std::string(bytes.rbegin(), bytes.rend());
        ascii += std::to_string(value) + " ";
    };
    for (const auto& p : points) {
        put_number(p[0]);
        put_number(static_cast<float>(p[1]));
        put_number(static_cast<std::int16_t>(p[2]));
        for (int c = 0; c < 3; ++c) put_number(static_cast<std::uint8_t>(255));
    }
    put_number(std::int32_t{5});
    for (std::uint8_t count : {std::uint8_t{4}, std::uint8_t{3}}) {
        put_number(std::uint8_t{1});
        put_number(count);
        for (std::uint32_t i = 0; i < count; ++i) put_number(i);
    }
    put(folder / "ascii.ply", ascii);
    put(folder / "little.ply", little);
    put(folder / "big.ply", big);
    for (const char* name : {"ascii.ply", "little.ply", "big.ply"}) {
        const RawMesh raw = read(folder / name);
        ASSERT_EQ(raw.points.size(), 4u) << name;
        EXPECT_EQ(raw.points[3], Point(0, 1, 7)) << name;
        EXPECT_EQ(raw.faces, (std::vector<Face>{{0, 1, 2}, {0, 2, 3}, {0, 1, 2}})) << name;
        EXPECT_EQ(raw.colors[0], (std::array<float, 4>{1, 1, 1, 1}));
    }
    for (std::size_t length = 0; length < little.size(); length += 7)
        expect_refused(folder, "cut.ply", little.substr(0, length), "cut.ply");
}

TEST(Import, BadPly) {
    Folder folder;
    const std::string vertices =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
    const std::string faces = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    expect_refused(folder, "a.ply", "nope", "ply");
    expect_refused(folder, "a.ply", "ply\nformat odd 1.0\nend_header\n", "line 2");
    expect_refused(folder, "a.ply", "ply\nend_header\n", "format");
    expect_refused(folder, "a.ply", vertices + faces + "0 0 0 1 0 0 0 1 0 3 0 1 3\n", "corner");
    expect_refused(folder, "a.ply", vertices + faces + "0 0 0 1 0 0 0 1 0 3 0 1 -1\n", "corner");
    expect_refused(folder, "a.ply", vertices + faces + "0 0 0 1 0 0 0 1 0 300 0 1 2\n", "list");
    expect_refused(folder, "a.ply", vertices + faces + "0 0 0 1 0 nan 0 1 0 3 0 1 2\n", "finite");
    expect_refused(folder, "a.ply",
                   "ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\nproperty float "
                   "z\nend_header\n0 0 0\n",
                   "do not fit");
    expect_refused(folder, "a.ply", "ply\nformat ascii 1.0\nelement nothing 4000000000\nend_header\n\n", "no faces");
    expect_refused(folder, "a.ply", vertices + "end_header\n0 0 0 1 0 0 0 1 0\n", "no faces");
}

TEST(Import, ShapeBecomesAGlb) {
    Folder folder;
    ShapeMesh shape;
    shape.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    shape.normals.assign(3, {0, 0, 1});
    shape.texcoords.assign(3, {0.5, 0.5});
    shape.faces = {{0, 1, 2}};
    write_glb(folder / "shape.glb", shape, "tile");
    const RawMesh raw = read(folder / "shape.glb");
    EXPECT_EQ(raw.name, "tile");
    EXPECT_EQ(raw.points[1], Point(1, 0, 0));
    EXPECT_EQ(raw.normals[2], Point(0, 0, 1));
    if (has_validator()) {
        EXPECT_EQ(validator_errors({folder / "shape.glb"}), "");
    }
}

TEST(AtomicWrite, ReplacesOrLeavesUntouched) {
    Folder folder;
    const auto write = [](const std::filesystem::path& file, const std::string& text) {
        write_file_atomically(file, {reinterpret_cast<const unsigned char*>(text.data()), text.size()});
    };
    const auto expect_output_error = [&](const std::filesystem::path& file) {
        try {
            write(file, "new");
            ADD_FAILURE() << "written: " << file;
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::output);
            EXPECT_NE(std::string(error.what()).find(file.string()), std::string::npos);
        }
    };
    write(folder / "a.glb", "old");
    write(folder / "a.glb", "new");
    EXPECT_EQ(get(folder / "a.glb"), "new");
    expect_output_error(folder / "missing/a.glb");
    std::filesystem::create_directory(folder / "folder");
    expect_output_error(folder / "folder");
    // A name that fits, but not with the temporary ending: nothing else of the folder changes.
    expect_output_error(folder / std::string(250, 'x'));
    put(folder / "real.glb", "old");
    std::filesystem::create_symlink("real.glb", folder / "link.glb");
    write(folder / "link.glb", "through");
    EXPECT_EQ(get(folder / "real.glb"), "through");
    EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.glb"));
    ASSERT_EQ(::chmod((folder / "a.glb").c_str(), 0640), 0);
    write(folder / "a.glb", "mode");
    struct stat status {};
    ASSERT_EQ(::stat((folder / "a.glb").c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777, 0640u);
    for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
        EXPECT_NE(entry.path().extension(), ".pvg-tmp") << entry.path();
}

TEST(AtomicWrite, UnwritableFolderKeepsTheOldFile) {
    if (::geteuid() == 0)
        GTEST_SKIP() << "root may write anywhere";
    Folder folder;
    std::filesystem::create_directory(folder / "closed");
    put(folder / "closed/a.glb", "old");
    ASSERT_EQ(::chmod((folder / "closed").c_str(), 0500), 0);
    const std::string text = "new";
    EXPECT_THROW(
        write_file_atomically(folder / "closed/a.glb", {reinterpret_cast<const unsigned char*>(text.data()), text.size()}),
        Error);
    EXPECT_EQ(get(folder / "closed/a.glb"), "old");
    ASSERT_EQ(::chmod((folder / "closed").c_str(), 0700), 0);
}

TEST(AtomicWrite, FullDeviceKeepsTheOldFile) {
    if (!std::filesystem::exists("/dev/full"))
        GTEST_SKIP();
    EXPECT_THROW(write_file_atomically("/dev/full", {}), Error);
}

}  // namespace
}  // namespace pvg::test
