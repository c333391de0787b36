#include "gltf/import_mesh.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "gltf/edition.h"
#include "gltf/files.h"
#include "gltf/glb.h"

namespace pvg {
namespace {

std::string ending(const std::filesystem::path& file) {
    std::string text = file.extension().string();
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

template <std::size_t N>
std::vector<float> flat(const std::vector<std::array<float, N>>& values) {
    std::vector<float> result;
    result.reserve(values.size() * N);
    for (const auto& value : values) result.insert(result.end(), value.begin(), value.end());
    return result;
}

/// Normals that are none (zero, not finite) take their triangle's: glTF wants unit vectors.
void make_unit(ImportedMesh& mesh) {
    if (mesh.normals.empty())
        return;
    const auto point = [&](int v) { return Point(mesh.points[v][0], mesh.points[v][1], mesh.points[v][2]); };
    std::vector<Point> sums;
    for (std::size_t v = 0; v < mesh.normals.size(); ++v) {
        Point normal(mesh.normals[v][0], mesh.normals[v][1], mesh.normals[v][2]);
        if (!(normal.norm() > 1e-12) || !normal.allFinite()) {
            if (sums.empty()) {
                sums.assign(mesh.points.size(), Point::Zero());
                for (const Face& f : mesh.faces) {
                    const Point area = (point(f[1]) - point(f[0])).cross(point(f[2]) - point(f[0]));
                    for (int corner : f) sums[corner] += area;
                }
            }
            normal = sums[v].norm() > 0 ? sums[v] : Point(0, 0, 1);
        }
        normal.normalize();
        mesh.normals[v] = {static_cast<float>(normal[0]), static_cast<float>(normal[1]), static_cast<float>(normal[2])};
    }
}

gltf::Edition edition_of(const ImportedMesh& mesh) {
    gltf::Document empty;
    empty.json = {
        {"asset", {{"version", "2.0"}, {"generator", "pvg " PVG_VERSION}}}, {"scene", 0}, {"scenes", {{{"nodes", {0}}}}}};
    gltf::Json node = {{"mesh", 0}}, described = gltf::Json::object();
    if (!mesh.name.empty())
        node["name"] = described["name"] = mesh.name;
    empty.json["nodes"] = gltf::Json::array({node});
    gltf::Edition edition(empty);
    constexpr int real = TINYGLTF_COMPONENT_TYPE_FLOAT;
    gltf::Json attributes;
    attributes["POSITION"] = edition.add_attribute(flat(mesh.points), "VEC3", real, false, true);
    if (!mesh.normals.empty())
        attributes["NORMAL"] = edition.add_attribute(flat(mesh.normals), "VEC3", real, false, false);
    if (!mesh.texcoords.empty())
        attributes["TEXCOORD_0"] = edition.add_attribute(flat(mesh.texcoords), "VEC2", real, false, false);
    if (!mesh.colors.empty()) {
        std::vector<float> colors = flat(mesh.colors);
        for (float& value : colors) value = std::round(std::clamp(value, 0.0f, 1.0f) * 65535);
        attributes["COLOR_0"] = edition.add_attribute(colors, "VEC4", TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, true, false);
    }
    std::vector<std::uint32_t> indices;
    for (const Face& face : mesh.faces)
        for (int corner : face) indices.push_back(static_cast<std::uint32_t>(corner));
    gltf::Json primitive = {{"attributes", attributes}};
    primitive["indices"] = edition.add_indices(indices, mesh.points.size());
    described["primitives"] = gltf::Json::array({primitive});
    edition.json["meshes"] = gltf::Json::array({described});
    return edition;
}

}  // namespace

bool is_mesh_file(const std::filesystem::path& file) {
    const std::string kind = ending(file);
    return kind == ".obj" || kind == ".off" || kind == ".ply";
}

ImportedMesh read_mesh_file(const std::filesystem::path& file, Warnings& warnings) {
    const std::vector<unsigned char> bytes = read_file(file);
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::string kind = ending(file);
    ImportedMesh mesh = kind == ".obj"   ? gltf::read_obj(file.string(), text, warnings)
                        : kind == ".off" ? gltf::read_off(file.string(), text, warnings)
                                         : gltf::read_ply(file.string(), text, warnings);
    if (mesh.faces.empty())
        throw Error(ErrorKind::bad_input, file.string() + ": the file has no faces");
    mesh.name = file.stem().string();
    // JSON wants UTF-8 and file names need not be.
    try {
        (void)gltf::Json(mesh.name).dump();
    } catch (const nlohmann::json::exception&) {
        mesh.name = "mesh";
    }
    make_unit(mesh);
    return mesh;
}

ImportedMesh imported(const ShapeMesh& shape, const std::string& name) {
    ImportedMesh mesh;
    mesh.name = name;
    const auto rounded = [](const Point& p) {
        return std::array<float, 3>{static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
    };
    for (const Point& p : shape.points) mesh.points.push_back(rounded(p));
    for (const Point& n : shape.normals) mesh.normals.push_back(rounded(n));
    for (const Eigen::Vector2d& t : shape.texcoords)
        mesh.texcoords.push_back({static_cast<float>(t[0]), static_cast<float>(t[1])});
    mesh.faces = shape.faces;
    make_unit(mesh);
    return mesh;
}

void write_glb(const std::filesystem::path& out, const ImportedMesh& mesh) { write_file_atomically(out, edition_of(mesh).glb()); }

void write_glb(const std::filesystem::path& out, const ShapeMesh& shape, const std::string& name) {
    write_glb(out, imported(shape, name));
}

namespace gltf {

std::pair<Json, Bytes> mesh_document(const ImportedMesh& mesh) {
    Edition edition = edition_of(mesh);
    const Bytes file = edition.glb();
    const GlbChunks chunks = split_glb("", file);
    return {edition.json, Bytes(chunks.bin->begin(), chunks.bin->end())};
}

}  // namespace gltf
}  // namespace pvg
