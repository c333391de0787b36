// What is read: every way to store triangles, the selection of a mesh, and hostile files that are refused by name and place.
#include <sys/stat.h>

#include <gtest/gtest.h>

#include "gltf/describe.h"
#include "gltf/fixtures.h"

namespace pvg::test {
namespace {

Draft triangle() {
    Draft draft;
    draft.one_mesh({{"POSITION", draft.positions({0, 0, 0, 1, 0, 0, 0, 1, 0})}});
    return draft;
}

/// Reading throws Error(bad_input) whose message holds the file's name and all words.
void expect_refused(const std::filesystem::path& file, const std::vector<std::string>& words) {
    Warnings warnings;
    try {
        MeshAsset::read(file, std::nullopt, warnings);
        ADD_FAILURE() << "read: " << file;
    } catch (const Error& error) {
        const std::string what = error.what();
        EXPECT_EQ(error.kind(), ErrorKind::bad_input);
        EXPECT_EQ(what.rfind(file.string() + ": ", 0), 0u) << what;
        for (const std::string& word : words) EXPECT_NE(what.find(word), std::string::npos) << word << " is not in: " << what;
    }
}

RawMesh read(const std::filesystem::path& file, const std::optional<std::string>& select = std::nullopt) {
    Warnings warnings;
    return MeshAsset::read(file, select, warnings).mesh();
}

TEST(Read, StripsAndFansAndPlainTriangles) {
    Folder folder;
    Draft draft;
    const auto square = draft.positions({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0});
    draft.one_mesh({{"POSITION", square}});
    Json& primitive = draft.json["meshes"][0]["primitives"][0];
    primitive["mode"] = 5;
    EXPECT_EQ(read(draft.write(folder)).faces, (std::vector<Face>{{0, 1, 2}, {1, 3, 2}}));
    primitive["mode"] = 6;
    EXPECT_EQ(read(draft.write(folder)).faces, (std::vector<Face>{{1, 2, 0}, {2, 3, 0}}));
    primitive["mode"] = 4;
    EXPECT_EQ(read(draft.write(folder)).faces, (std::vector<Face>{{0, 1, 2}}));
    primitive["indices"] = draft.accessor<std::uint8_t>({3, 2, 1}, 5121, "SCALAR", 1);
    EXPECT_EQ(read(draft.write(folder)).faces, (std::vector<Face>{{3, 2, 1}}));
}

TEST(Read, InterleavedAndSparse) {
    Folder folder;
    Draft draft;
    // Position and colour of three vertices, 16 bytes apart.
    for (int v = 0; v < 3; ++v) {
        draft.bin += bytes_of<float>({static_cast<float>(v == 1), static_cast<float>(v == 2), 0});
        draft.bin += bytes_of<std::uint8_t>({255, 0, static_cast<std::uint8_t>(51 * v), 255});
    }
    draft.json["bufferViews"] = {{{"buffer", 0}, {"byteLength", 48}, {"byteStride", 16}}};
    draft.json["accessors"] = {
        {{"bufferView", 0}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}, {"min", {0, 0, 0}}, {"max", {1, 1, 7}}},
        {{"bufferView", 0}, {"byteOffset", 12}, {"componentType", 5121}, {"normalized", true}, {"count", 3}, {"type", "VEC4"}}};
    draft.json["accessors"][0]["sparse"] = {
        {"count", 1}, {"indices", {{"bufferView", 1}, {"componentType", 5121}}}, {"values", {{"bufferView", 2}}}};
    draft.json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 48}, {"byteLength", 1}});
    draft.json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 52}, {"byteLength", 12}});
    draft.bin += bytes_of<std::uint8_t>({2, 0, 0, 0}) + bytes_of<float>({0, 1, 7});
    draft.one_mesh({{"POSITION", 0}, {"COLOR_0", 1}});
    const RawMesh raw = read(draft.write(folder));
    EXPECT_EQ(raw.points[1], Point(1, 0, 0));
    EXPECT_EQ(raw.points[2], Point(0, 1, 7));
    EXPECT_EQ(raw.colors[1][2], 51 / 255.0f);
    draft.json["accessors"][0]["sparse"]["indices"]["byteOffset"] = 3;
    draft.bin[51] = 3;
    expect_refused(draft.write(folder), {"/accessors/0/sparse/indices", "3"});
}

TEST(Read, SelectionByMeshThenNodeThenIndex) {
    Folder folder;
    Draft draft;
    draft.one_mesh({{"POSITION", draft.positions({0, 0, 0, 1, 0, 0, 0, 1, 0})}});
    Json second = draft.json["meshes"][0];
    second["name"] = "0";
    draft.json["meshes"][0]["name"] = "body";
    draft.json["meshes"].push_back(second);
    draft.json["nodes"] = {{{"mesh", 1}, {"name", "hat"}}, {{"name", "empty"}}};
    const auto file = draft.write(folder);
    EXPECT_EQ(read(file, "body").name, "body");
    EXPECT_EQ(read(file, "hat").name, "0");
    EXPECT_EQ(read(file, "0").name, "0") << "a name goes before an index";
    EXPECT_EQ(read(file, "1").name, "0");
    expect_refused(file, {"/meshes", "several", "\"body\"", "\"0\""});
    for (const char* wrong : {"empty", "2", "-1", "nobody", ""}) EXPECT_THROW(read(file, wrong), Error) << wrong;
}

TEST(Read, RangesAreChecked) {
    Folder folder;
    const auto broken = [&](auto&& change, const std::vector<std::string>& words) {
        Draft draft = triangle();
        draft.json["meshes"][0]["primitives"][0]["indices"] = draft.accessor<std::uint16_t>({0, 1, 2}, 5123, "SCALAR", 1);
        change(draft);
        expect_refused(draft.write(folder), words);
    };
    broken([](Draft& d) { d.bin[d.bin.size() - 2] = 3; }, {"/accessors/1", "3"});
    broken([](Draft& d) { d.json["accessors"][0]["count"] = 4; }, {"/accessors/0", "4 elements"});
    broken([](Draft& d) { d.json["accessors"][0]["count"] = 2147483648; }, {"/accessors/0", "2147483648"});
    broken([](Draft& d) { d.json["accessors"][0]["count"] = 18446744073709551615u; }, {"/accessors/0"});
    broken([](Draft& d) { d.json["accessors"][0]["byteOffset"] = 18446744073709551612u; }, {"/accessors/0"});
    broken([](Draft& d) { d.json["accessors"][0]["byteOffset"] = 2; }, {"/accessors/0", "aligned"});
    broken([](Draft& d) { d.json["accessors"][0]["byteOffset"] = -4; }, {"/accessors/0/byteOffset", "-4"});
    broken([](Draft& d) { d.json["accessors"][0]["componentType"] = 5130; }, {"/accessors/0/componentType", "5130"});
    broken([](Draft& d) { d.json["accessors"][0]["type"] = "VEC9"; }, {"/accessors/0/type", "VEC9"});
    broken([](Draft& d) { d.json["accessors"][0]["bufferView"] = 7; }, {"/accessors/0/bufferView", "7"});
    broken([](Draft& d) { d.json["bufferViews"][0]["byteOffset"] = 1000; }, {"/bufferViews/0"});
    broken([](Draft& d) { d.json["bufferViews"][0]["byteLength"] = 1e300; }, {"/bufferViews/0/byteLength"});
    broken([](Draft& d) { d.json["bufferViews"][0]["byteStride"] = 2; }, {"/bufferViews/0/byteStride"});
    broken([](Draft& d) { d.json["bufferViews"][0]["buffer"] = 1; }, {"/bufferViews/0/buffer"});
    broken([](Draft& d) { d.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 9; },
           {"/meshes/0/primitives/0/attributes/POSITION", "9"});
    broken([](Draft& d) { d.json["meshes"][0]["primitives"][0]["indices"] = 0; }, {"/accessors/0", "unsigned"});
    broken([](Draft& d) { d.json["meshes"][0]["primitives"][0]["mode"] = 7; }, {"/meshes/0/primitives/0/mode"});
    broken([](Draft& d) { d.json["meshes"][0]["primitives"][0]["material"] = 0; }, {"/meshes/0/primitives/0/material"});
    broken([](Draft& d) { d.json["nodes"][0]["children"] = {0}; }, {"/nodes/0"});
    broken([](Draft& d) { d.json["scenes"][0]["nodes"] = {4}; }, {"/scenes/0/nodes/0"});
    broken([](Draft& d) { d.json["meshes"] = "many"; }, {"/meshes", "array"});
    broken([](Draft& d) { d.json["asset"]["version"] = "1.0"; }, {"/asset/version"});
    broken([](Draft& d) { d.json["extensionsRequired"] = {"ACME_magic"}; }, {"/extensionsRequired/0", "ACME_magic"});
    broken([](Draft& d) { d.json["extensionsRequired"] = {"KHR_draco_mesh_compression"}; },
           {"/extensionsRequired/0", "compressed"});
    broken(
        [](Draft& d) {
            d.json["buffers"] = {{{"uri", "data.bin"}, {"byteLength", d.bin.size() + 1}}};
        },
        {"/buffers/0/byteLength"});
    broken(
        [](Draft& d) {
            d.json["buffers"] = {{{"uri", "data.bin"}, {"byteLength", 99999999999999}}};
        },
        {"/buffers/0/byteLength"});
}

TEST(Read, ZerosWithoutDataAreBounded) {
    Folder folder;
    Draft draft = triangle();
    draft.json["accessors"][0].erase("bufferView");
    draft.json["accessors"][0]["count"] = 2147483648;
    expect_refused(draft.write(folder), {"2147483648"});
    draft.json["accessors"][0]["count"] = 40000000;
    expect_refused(draft.write(folder), {"40000000"});
}

TEST(Read, PositionsAreFinite) {
    Folder folder;
    for (float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        Draft draft;
        draft.one_mesh({{"POSITION", draft.accessor<float>({0, 0, 0, 1, 0, 0, 0, bad, 0}, 5126, "VEC3", 3)}});
        expect_refused(draft.write(folder), {"/accessors/0", "element 2"});
    }
}

TEST(Read, UrisStayInTheFolder) {
    Folder folder;
    Draft draft = triangle();
    const auto with_uri = [&](const std::string& uri) {
        draft.json["buffers"] = {{{"uri", uri}, {"byteLength", draft.bin.size()}}};
        return draft.write(folder, "inner/mesh.gltf");
    };
    std::filesystem::create_directory(folder / "inner");
    put(folder / "secret.bin", draft.bin);
    put(folder / "inner/own data.bin", draft.bin);
    EXPECT_EQ(read(with_uri("own%20data.bin")).points.size(), 3u);
}

TEST(Read, UrisThatLeadOutAreRefused) {
    Folder folder;
    Draft draft = triangle();
    std::filesystem::create_directory(folder / "inner");
    std::filesystem::create_directory(folder / "inner/sub");
    put(folder / "secret.bin", draft.bin);
    put(folder / "inner/own.bin", draft.bin);
    std::filesystem::create_symlink(folder / "secret.bin", folder / "inner/link.bin");
    std::filesystem::create_directory_symlink(folder.path(), folder / "inner/up");
    std::filesystem::create_symlink("own.bin", folder / "inner/inside.bin");
    ASSERT_EQ(mkfifo((folder / "inner/pipe").c_str(), 0600), 0);
    const auto with_uri = [&](const std::string& uri) {
        draft.json["buffers"] = {{{"uri", uri}, {"byteLength", draft.bin.size()}}};
        return draft.write(folder, "inner/mesh.gltf");
    };
    EXPECT_EQ(read(with_uri("inside.bin")).points.size(), 3u);
    EXPECT_EQ(read(with_uri("sub/../own.bin")).points.size(), 3u);
    for (const std::string uri :
         {"../secret.bin", "%2e%2e/secret.bin", "sub/../../secret.bin", "link.bin", "up/secret.bin", "..%2fsecret.bin",
          "%2fetc%2fpasswd", "/etc/passwd", "pipe", "sub", ".", "own.bin%00", "%zz", "none.bin", ""})
        expect_refused(with_uri(uri), {"/buffers/0/uri"});
    expect_refused(with_uri((folder / "secret.bin").string()), {"/buffers/0/uri"});
    expect_refused(with_uri("file://" + (folder / "secret.bin").string()), {"no data"});
}

TEST(Read, DataUris) {
    Folder folder;
    Draft draft = triangle();
    draft.json["buffers"] = {
        {{"uri", "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}, {"byteLength", 36}}};
    EXPECT_EQ(read(draft.write(folder)).points[2], Point(0, 1, 0));
    for (const char* uri : {"data:application/octet-stream;base64,AAA", "data:application/octet-stream;base64,????",
                            "data:nothing", "data:;base64,A"}) {
        draft.json["buffers"][0]["uri"] = uri;
        expect_refused(draft.write(folder), {"/buffers/0"});
    }
}

TEST(Read, JsonIsBounded) {
    Folder folder;
    const auto text = [&](const std::string& json) {
        put(folder / "mesh.gltf", json);
        return folder / "mesh.gltf";
    };
    expect_refused(text(std::string(200000, '[')), {"256 deep"});
    expect_refused(text("{\"extras\":" + std::string(300, '[') + std::string(300, ']') + "}"), {"256 deep"});
    expect_refused(text(""), {"JSON"});
    expect_refused(text("]]]]"), {"JSON"});
    expect_refused(text("{\"asset\":"), {"JSON"});
    expect_refused(text("\xef\xbb\xbf{}"), {"byte order mark"});
    expect_refused(text("{\"asset\":{\"version\":\"2.0\"},\"extras\":\"\xff\"}"), {"JSON"});
    expect_refused(text("[]"), {"object"});
    std::string wide = "{\"asset\":{\"version\":\"2.0\"},\"extras\":{";
    for (int i = 0; i < 40000; ++i) wide += "\"k" + std::to_string(i) + "\":0,";
    expect_refused(text(wide + "\"end\":0}}"), {"members"});
}

TEST(Read, JsonMayNestTwoHundred) {
    Folder folder;
    Draft draft = triangle();
    Json deep = 1;
    for (int i = 0; i < 200; ++i) deep = Json::array({deep});
    draft.json["extras"] = deep;
    EXPECT_EQ(read(draft.write(folder)).points.size(), 3u);
}

TEST(Read, GlbContainersAreChecked) {
    Folder folder;
    Draft draft = triangle();
    const auto file = draft.write(folder);
    Opened opened(file);
    opened.write(folder / "good.glb", opened.identity());
    const std::string good = get(folder / "good.glb");
    EXPECT_EQ(read(folder / "good.glb").points.size(), 3u);
    for (std::size_t length = 0; length < good.size(); length += 3) {
        put(folder / "cut.glb", good.substr(0, length));
        expect_refused(folder / "cut.glb", {"byte"});
    }
    for (std::size_t at : {0, 4, 8, 12, 16}) {
        std::string bad = good;
        bad[at + 1] = '\x7f';
        put(folder / "bad.glb", bad);
        expect_refused(folder / "bad.glb", {"byte"});
    }
    expect_refused(folder / "none.glb", {});
    expect_refused(folder.path(), {"regular"});
}

TEST(Read, EveryByteOfASmallFileMayBeWrong) {
    // Whatever is changed, reading and writing either works or throws an Error: no crash, no other exception.
    Folder folder;
    Draft draft = triangle();
    draft.json["meshes"][0]["primitives"][0]["indices"] = draft.accessor<std::uint16_t>({0, 1, 2}, 5123, "SCALAR", 1);
    draft.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorFactor", {1, 0, 0, 1}}}}}};
    draft.json["meshes"][0]["primitives"][0]["material"] = 0;
    Opened opened(draft.write(folder));
    opened.write(folder / "good.glb", opened.identity());
    const std::string good = get(folder / "good.glb");
    int refused = 0;
    for (std::size_t at = 0; at < good.size(); ++at) {
        constexpr std::array values{'\0', '9', '\xff', '[', '-'};
        std::string bad = good;
        bad[at] = values[at % values.size()];
        put(folder / "bad.glb", bad);
        try {
            Opened changed(folder / "bad.glb");
            changed.write(folder / "out.glb", changed.lifted(0.1));
        } catch (const Error&) {
            ++refused;
        }
    }
    EXPECT_GT(refused, 200);
}

TEST(Read, DescribeListsTheMeshes) {
    Folder folder;
    Draft draft = triangle();
    draft.json["meshes"][0]["name"] = "body";
    Warnings warnings;
    const Json info = describe_mesh_file(draft.write(folder), warnings);
    EXPECT_EQ(info["format"], "gltf");
    EXPECT_EQ(info["meshes"][0]["name"], "body");
    EXPECT_EQ(info["meshes"][0]["triangles"], 1);
    EXPECT_EQ(info["meshes"][0]["primitives"][0]["mode"], "triangles");
}

}  // namespace
}  // namespace pvg::test
