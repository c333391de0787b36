// A mesh file as pvg sees it, and the way back into a .glb. Reading: glTF 2.0 (.glb, .gltf), .obj, .off, .ply. Writing edits the
// input's own JSON document and appends buffers, so that everything that was not decorated survives byte for byte.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "mesh/surface.h"
#include "mesh/surface_map.h"
#include "pvg/status.h"

namespace pvg {

/// The selected mesh as one triangle soup. Raw vertex = (primitive, vertex) in order of primitives; raw face likewise.
struct RawMesh {
    std::string name;
    std::vector<Point> points;                      ///< R: positions, decoded to the mesh's local coordinates; exact
    std::vector<std::array<float, 4>> colors;       ///< R: COLOR_0, linear; white where the mesh has none
    std::vector<std::array<float, 3>> base_colors;  ///< R: the material's base colour factor, linear; white where there is none
    std::vector<Point> normals;                     ///< R, or empty where a primitive has none
    std::vector<Face> faces;                        ///< raw triangles
    std::vector<int> face_primitive;                ///< per raw face
};

/// What decorate makes of it. Vertices here are those of the output surface (slit, with all copies).
struct DecoratedMesh {
    /// n output vertices
    std::vector<std::array<float, 3>> position;     ///< displaced
    std::vector<std::array<float, 3>> base;         ///< undisplaced
    std::vector<VertexOrigin> origin;               ///< over WELDED vertices of the input
    std::vector<char> decorated;                    ///< 1 where a field reaches it (colour or height)
    std::vector<char> color_decorated;              ///< 1 where colour is reached: then `color` replaces COLOR_0's RGB
    std::vector<char> moved;                        ///< 1 where any height moves it
    std::vector<std::array<float, 4>> color;        ///< linear RGB composited over the input, alpha ignored (the input's stays)
    std::vector<std::array<float, 4>> field_color;  ///< _PVG_COLOR
    std::vector<float> field_height;                ///< _PVG_HEIGHT
    std::vector<std::array<float, 2>> dirichlet;    ///< _PVG_DIRICHLET
    std::vector<std::array<float, 2>> cell;         ///< _PVG_CELL

    /// Faces of the output surface: corners are output vertices.
    std::vector<Face> faces;
    std::vector<int> raw_face;                  ///< the raw face that contains each
    std::vector<Face> corner_normal;            ///< per corner: index into `normals`, or none: interpolate the input's normal
    std::vector<std::array<float, 3>> normals;  ///< shading normals

    /// Walls that close the cliff of a two-height diffusion curve: triangles with own vertices.
    struct Wall {
        std::array<int, 3> vertex;    ///< output vertices that lend position and colour
        std::array<float, 3> normal;  ///< flat
        int raw_face = none;          ///< lends primitive, material and other attributes
    };
    std::vector<Wall> walls;
};

struct WriteOptions {
    bool fields = false;
    nlohmann::json scene;  ///< embedded in extras.pvg
};

/// An input file, kept whole.
class MeshAsset {
public:
    /// Reads and checks a file. Throws Error(bad_input) naming file and place. select: as in the scene's mesh.select.
    static MeshAsset read(const std::filesystem::path& file, const std::optional<std::string>& select, Warnings& warnings);
    ~MeshAsset();
    MeshAsset(MeshAsset&&) noexcept;
    MeshAsset& operator=(MeshAsset&&) noexcept;

    const RawMesh& mesh() const;
    /// For each raw face, the welded vertices of its corners are needed to find raw attributes again: corner k of raw face f is
    /// welded vertex welded_faces[f][k] (none for a face that welding left out; such faces are written unchanged).
    /// Writes OUT atomically. Throws Error(output) or Error(bad_input).
    void write(const std::filesystem::path& out, const DecoratedMesh& mesh, const std::vector<Face>& welded_faces,
               const WriteOptions& options, Warnings& warnings) const;

    /// A scene embedded by an earlier decorate, if any.
    std::optional<nlohmann::json> embedded_scene() const;

private:
    MeshAsset();
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace pvg
