#include "gltf/output_mesh.h"

#include <string>
#include <unordered_map>

namespace pvg::gltf {
namespace {

[[noreturn]] void refuse(const std::string& what) {
    throw Error(ErrorKind::bad_input, "the decorated mesh does not fit the file's: " + what);
}

struct VertexKey {
    std::array<int, 5> parts;
    bool operator==(const VertexKey&) const = default;
};

struct VertexHash {
    std::size_t operator()(const VertexKey& key) const {
        std::uint64_t h = 0x9e3779b97f4a7c15ull;
        for (int part : key.parts) {
            h ^= static_cast<std::uint32_t>(part);
            h *= 0xff51afd7ed558ccdull;
            h ^= h >> 32;
        }
        return static_cast<std::size_t>(h);
    }
};

void check_sizes(const RawMesh& raw, const DecoratedMesh& mesh, const std::vector<Face>& welded_faces, bool fields) {
    const std::size_t n = mesh.position.size();
    const auto expect = [&](std::size_t size, std::size_t right, const char* what) {
        if (size != right)
            refuse(std::string(what) + " has " + std::to_string(size) + " entries, expected " + std::to_string(right));
    };
    expect(welded_faces.size(), raw.faces.size(), "welded_faces");
    expect(mesh.origin.size(), n, "origin");
    expect(mesh.decorated.size(), n, "decorated");
    expect(mesh.color_decorated.size(), n, "color_decorated");
    expect(mesh.moved.size(), n, "moved");
    expect(mesh.color.size(), n, "color");
    if (fields) {
        expect(mesh.base.size(), n, "base");
        expect(mesh.field_color.size(), n, "field_color");
        expect(mesh.field_height.size(), n, "field_height");
        expect(mesh.dirichlet.size(), n, "dirichlet");
        expect(mesh.cell.size(), n, "cell");
    }
    expect(mesh.raw_face.size(), mesh.faces.size(), "raw_face");
    if (!mesh.corner_normal.empty())
        expect(mesh.corner_normal.size(), mesh.faces.size(), "corner_normal");
    const auto vertex_in_range = [&](int v) { return v >= 0 && static_cast<std::size_t>(v) < n; };
    const auto raw_face_in_range = [&](int f) { return f >= 0 && static_cast<std::size_t>(f) < raw.faces.size(); };
    for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
        if (!raw_face_in_range(mesh.raw_face[f]))
            refuse("face " + std::to_string(f) + " lies on no raw face");
        for (int k = 0; k < 3; ++k) {
            if (!vertex_in_range(mesh.faces[f][k]))
                refuse("face " + std::to_string(f) + " has a corner that is no vertex");
            if (!mesh.corner_normal.empty() &&
                (mesh.corner_normal[f][k] < none || mesh.corner_normal[f][k] >= static_cast<int>(mesh.normals.size())))
                refuse("face " + std::to_string(f) + " has a normal out of range");
        }
    }
    for (const DecoratedMesh::Wall& wall : mesh.walls) {
        if (!raw_face_in_range(wall.raw_face))
            refuse("a wall lies on no raw face");
        for (int v : wall.vertex)
            if (!vertex_in_range(v))
                refuse("a wall has a corner that is no vertex");
    }
}

/// Numbers the vertices of one primitive as its triangles ask for them.
class VertexNumbers {
public:
    VertexNumbers(OutputPrimitive& out, const RawPrimitive& primitive, const RawMesh& raw, const DecoratedMesh& mesh,
                  const std::vector<Face>& welded_faces)
        : out_(&out), primitive_(&primitive), raw_(&raw), mesh_(&mesh), welded_faces_(&welded_faces) {}

    /// The output vertex seen from a raw face. Its origin's welded vertices are corners of that face.
    OutputVertex on_face(int vertex, int raw_face) const {
        OutputVertex result;
        result.vertex = vertex;
        const VertexOrigin& origin = mesh_->origin[vertex];
        for (int i = 0; i < 3; ++i) {
            if (origin.vertex[i] == none)
                break;
            int corner = none;
            for (int k = 0; k < 3; ++k)
                if ((*welded_faces_)[raw_face][k] == origin.vertex[i])
                    corner = k;
            if (corner == none) {
                result.raw[0] = none;
                return result;
            }
            result.raw[i] = raw_->faces[raw_face][corner] - static_cast<int>(primitive_->first_vertex);
            result.weight[i] = origin.weight[i];
        }
        return result;
    }

    std::uint32_t shared(const OutputVertex& vertex) {
        const VertexKey key{{vertex.vertex, vertex.raw[0], vertex.raw[1], vertex.raw[2], vertex.normal}};
        const auto [at, fresh] = numbers_.emplace(key, static_cast<std::uint32_t>(out_->vertices.size()));
        if (fresh)
            out_->vertices.push_back(vertex);
        return at->second;
    }

private:
    OutputPrimitive* out_;
    const RawPrimitive* primitive_;
    const RawMesh* raw_;
    const DecoratedMesh* mesh_;
    const std::vector<Face>* welded_faces_;
    std::unordered_map<VertexKey, std::uint32_t, VertexHash> numbers_;
};

/// Per primitive of the list: is anything in it different from the input?
void mark_changes(std::vector<OutputPrimitive>& out, const std::vector<int>& owner, const DecoratedMesh& mesh,
                  const std::vector<Face>& welded_faces) {
    std::vector<std::size_t> before(out.size(), 0), after(out.size(), 0);
    for (std::size_t f = 0; f < welded_faces.size(); ++f)
        if (welded_faces[f][0] != none)
            ++before[owner[f]];
    for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
        const int p = owner[mesh.raw_face[f]];
        ++after[p];
        for (int v : mesh.faces[f]) {
            if (mesh.decorated[v] || mesh.moved[v] || mesh.color_decorated[v])
                out[p].decorated = true;
            if (!mesh.origin[v].is_vertex())
                out[p].changed = true;
        }
    }
    for (const DecoratedMesh::Wall& wall : mesh.walls) out[owner[wall.raw_face]].decorated = true;
    for (std::size_t p = 0; p < out.size(); ++p) out[p].changed = out[p].changed || out[p].decorated || before[p] != after[p];
}

}  // namespace

std::vector<OutputPrimitive> output_primitives(const RawMesh& raw, const std::vector<RawPrimitive>& primitives,
                                               const DecoratedMesh& mesh, const std::vector<Face>& welded_faces, bool fields) {
    check_sizes(raw, mesh, welded_faces, fields);
    std::vector<int> owner(raw.faces.size(), none);
    for (std::size_t p = 0; p < primitives.size(); ++p)
        for (std::size_t f = 0; f < primitives[p].face_count; ++f) owner[primitives[p].first_face + f] = static_cast<int>(p);
    std::vector<OutputPrimitive> out(primitives.size());
    mark_changes(out, owner, mesh, welded_faces);

    std::vector<VertexNumbers> numbers;
    for (std::size_t p = 0; p < primitives.size(); ++p) numbers.emplace_back(out[p], primitives[p], raw, mesh, welded_faces);
    for (std::size_t p = 0; p < out.size(); ++p)
        if (!out[p].changed)
            for (std::size_t v = 0; v < primitives[p].vertex_count; ++v) {
                OutputVertex vertex;
                vertex.raw[0] = static_cast<int>(v);
                out[p].vertices.push_back(vertex);
            }
    for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
        const int p = owner[mesh.raw_face[f]];
        if (!out[p].changed)
            continue;
        std::array<std::uint32_t, 3> triangle;
        for (int k = 0; k < 3; ++k) {
            OutputVertex vertex = numbers[p].on_face(mesh.faces[f][k], mesh.raw_face[f]);
            if (vertex.raw[0] == none)
                refuse("corner " + std::to_string(k) + " of face " + std::to_string(f) + " does not lie on raw face " +
                       std::to_string(mesh.raw_face[f]));
            if (!mesh.corner_normal.empty())
                vertex.normal = mesh.corner_normal[f][k];
            triangle[k] = numbers[p].shared(vertex);
        }
        out[p].triangles.push_back(triangle);
    }
    for (std::size_t f = 0; f < raw.faces.size(); ++f) {
        const int p = owner[f];
        if (!out[p].changed || welded_faces[f][0] != none)
            continue;
        std::array<std::uint32_t, 3> triangle;
        for (int k = 0; k < 3; ++k) {
            OutputVertex vertex;
            vertex.raw[0] = raw.faces[f][k] - static_cast<int>(primitives[p].first_vertex);
            triangle[k] = numbers[p].shared(vertex);
        }
        out[p].triangles.push_back(triangle);
    }
    for (std::size_t w = 0; w < mesh.walls.size(); ++w) {
        const DecoratedMesh::Wall& wall = mesh.walls[w];
        const int p = owner[wall.raw_face];
        std::array<std::uint32_t, 3> triangle;
        for (int k = 0; k < 3; ++k) {
            OutputVertex vertex = numbers[p].on_face(wall.vertex[k], wall.raw_face);
            if (vertex.raw[0] == none) {
                // The lending vertex is not on that face: the face's own corner lends the attributes.
                vertex.raw = {raw.faces[wall.raw_face][k] - static_cast<int>(primitives[p].first_vertex), none, none};
                vertex.weight = {1, 0, 0};
            }
            vertex.wall = static_cast<int>(w);
            triangle[k] = static_cast<std::uint32_t>(out[p].vertices.size());
            out[p].vertices.push_back(vertex);
        }
        out[p].triangles.push_back(triangle);
    }
    return out;
}

}  // namespace pvg::gltf
