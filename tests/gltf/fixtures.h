// Fixtures of the glTF tests: folders that go away, documents made in code, decorations that change nothing or everything.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "gltf/asset.h"
#include "gltf/files.h"
#include "mesh/weld.h"

namespace pvg::test {

using Json = nlohmann::ordered_json;

/// A folder of its own under the system's temporary folder, removed at the end.
class Folder {
public:
    Folder() {
        std::string name = (std::filesystem::temp_directory_path() / "pvg-gltf-XXXXXX").string();
        if (!mkdtemp(name.data()))
            throw std::runtime_error("no temporary folder");
        path_ = name;
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    ~Folder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

inline void put(const std::filesystem::path& file, const std::string& text) { std::ofstream(file, std::ios::binary) << text; }

inline std::string get(const std::filesystem::path& file) {
    const auto bytes = read_file(file);
    return {bytes.begin(), bytes.end()};
}

/// The bytes of numbers, little-endian.
template <typename T>
std::string bytes_of(const std::vector<T>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

/// A document under construction with one buffer "data.bin".
struct Draft {
    Json json = {{"asset", {{"version", "2.0"}}}};
    std::string bin;

    /// Appends an accessor over a view of its own and returns it.
    template <typename T>
    std::size_t accessor(const std::vector<T>& values, int component_type, const std::string& type, std::size_t components,
                         bool normalized = false) {
        while (bin.size() % 4) bin += '\0';
        json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", bin.size()}, {"byteLength", values.size() * sizeof(T)}});
        if (components * sizeof(T) % 4 != 0 && components > 1)
            json["bufferViews"].back()["byteStride"] = (components * sizeof(T) + 3) / 4 * 4;
        bin += bytes_of(values);
        Json accessor = {{"bufferView", json["bufferViews"].size() - 1},
                         {"componentType", component_type},
                         {"count", values.size() / components},
                         {"type", type}};
        if (normalized)
            accessor["normalized"] = true;
        json["accessors"].push_back(accessor);
        return json["accessors"].size() - 1;
    }
    std::size_t positions(const std::vector<float>& values) {
        const std::size_t a = accessor(values, 5126, "VEC3", 3);
        for (const bool upper : {false, true}) {
            std::vector<float> bound(values.begin(), values.begin() + 3);
            for (std::size_t i = 0; i < values.size(); ++i)
                bound[i % 3] = upper ? std::max(bound[i % 3], values[i]) : std::min(bound[i % 3], values[i]);
            json["accessors"][a][upper ? "max" : "min"] = bound;
        }
        return a;
    }
    /// Finishes the buffer and writes NAME and data.bin.
    std::filesystem::path write(const Folder& folder, const std::string& name = "mesh.gltf") {
        Json finished = json;
        if (!bin.empty() && !json.contains("buffers"))
            finished["buffers"] = {{{"uri", "data.bin"}, {"byteLength", bin.size()}}};
        put(folder / "data.bin", bin);
        put(folder / name, finished.dump());
        return folder / name;
    }
    void one_mesh(const Json& attributes) {
        json["meshes"] = {{{"primitives", {{{"attributes", attributes}}}}}};
        json["nodes"] = {{{"mesh", 0}}};
        json["scenes"] = {{{"nodes", {0}}}};
        json["scene"] = 0;
    }
};

/// A read asset with its welded surface.
struct Opened {
    Warnings warnings;
    MeshAsset asset;
    WeldedMesh welded;

    explicit Opened(const std::filesystem::path& file, const std::optional<std::string>& select = std::nullopt)
        : asset(MeshAsset::read(file, select, warnings)), welded(weld(asset.mesh().points, asset.mesh().faces, warnings)) {}

    /// The decoration that changes nothing.
    DecoratedMesh identity() const {
        DecoratedMesh mesh;
        const Surface& surface = welded.surface;
        const std::size_t n = static_cast<std::size_t>(surface.vertex_count());
        for (int v = 0; v < surface.vertex_count(); ++v) {
            const Point& p = surface.point(v);
            mesh.position.push_back({static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
            mesh.origin.push_back({{v, none, none}, {1, 0, 0}});
        }
        mesh.base = mesh.position;
        mesh.decorated.assign(n, 0);
        mesh.color_decorated.assign(n, 0);
        mesh.moved.assign(n, 0);
        mesh.color.assign(n, {0, 0, 0, 0});
        mesh.field_color.assign(n, {0, 0, 0, 0});
        mesh.field_height.assign(n, 0);
        mesh.dirichlet.assign(n, {0, 0});
        mesh.cell.assign(n, {-1, -1});
        mesh.faces = surface.faces();
        mesh.raw_face = welded.face_raw;
        mesh.corner_normal.assign(mesh.faces.size(), {none, none, none});
        return mesh;
    }

    /// Every vertex coloured red and lifted by `height` along its normal, new smooth normals.
    DecoratedMesh lifted(double height) const {
        DecoratedMesh mesh = identity();
        const std::vector<Point> normals = vertex_normals(welded.surface);
        for (std::size_t v = 0; v < mesh.position.size(); ++v) {
            const Point p = welded.surface.point(static_cast<int>(v)) + height * normals[v];
            mesh.position[v] = {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
            const Point n = normals[v].norm() > 0 ? normals[v] : Point(0, 0, 1);
            mesh.normals.push_back({static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])});
            mesh.color[v] = {0.75f, 0.25f, 0.0f, 1.0f};
        }
        mesh.decorated.assign(mesh.position.size(), 1);
        mesh.color_decorated = mesh.moved = mesh.decorated;
        mesh.corner_normal = mesh.faces;
        return mesh;
    }

    /// The midpoint subdivision, nothing reached.
    DecoratedMesh refined(const RefinedSurface& fine) const {
        DecoratedMesh mesh;
        const std::size_t n = static_cast<std::size_t>(fine.surface.vertex_count());
        for (const Point& p : fine.surface.points())
            mesh.position.push_back({static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
        mesh.base = mesh.position;
        mesh.origin = fine.map.vertex;
        mesh.decorated.assign(n, 0);
        mesh.color_decorated = mesh.moved = mesh.decorated;
        mesh.color.assign(n, {0, 0, 0, 0});
        mesh.field_color = mesh.color;
        mesh.field_height.assign(n, 0);
        mesh.dirichlet.assign(n, {0, 0});
        mesh.cell.assign(n, {-1, -1});
        mesh.faces = fine.surface.faces();
        for (int face : fine.map.face) mesh.raw_face.push_back(welded.face_raw[face]);
        mesh.corner_normal.assign(mesh.faces.size(), {none, none, none});
        return mesh;
    }

    void write(const std::filesystem::path& out, const DecoratedMesh& mesh, const WriteOptions& options = {}) {
        asset.write(out, mesh, welded.raw_to_welded, options, warnings);
    }
};

/// The JSON chunk of a .glb.
inline Json json_of(const std::filesystem::path& glb) {
    const std::string all = get(glb);
    std::uint32_t length = 0;
    std::memcpy(&length, all.data() + 12, 4);
    return Json::parse(all.substr(20, length));
}

/// The BIN chunk of a .glb.
inline std::string bin_of(const std::filesystem::path& glb) {
    const std::string all = get(glb);
    std::uint32_t json_length = 0, length = 0;
    std::memcpy(&json_length, all.data() + 12, 4);
    if (20 + json_length >= all.size())
        return "";
    std::memcpy(&length, all.data() + 20 + json_length, 4);
    return all.substr(28 + json_length, length);
}

/// Values of a packed accessor of a .glb that we wrote.
template <typename T>
std::vector<T> values_of(const std::filesystem::path& glb, std::size_t accessor) {
    const Json json = json_of(glb);
    const Json& a = json["accessors"][accessor];
    const Json& view = json["bufferViews"][a["bufferView"].get<std::size_t>()];
    const std::string bin = bin_of(glb);
    std::vector<T> values(view["byteLength"].get<std::size_t>() / sizeof(T));
    std::memcpy(values.data(), bin.data() + view.value("byteOffset", std::size_t{0}), values.size() * sizeof(T));
    return values;
}

/// A folder named by an environment variable, or empty.
inline std::filesystem::path folder_from(const char* variable) {
    const char* value = std::getenv(variable);
    return value ? std::filesystem::path(value) : std::filesystem::path();
}

}  // namespace pvg::test
