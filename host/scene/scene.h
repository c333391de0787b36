// The scene file NAME.pvg.json as data: parsed, validated against its schema, defaults filled in, nothing resolved
// against a mesh yet. Every node keeps its JSON pointer, so that later stages can name the place too.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "pvg/status.h"

namespace pvg {

enum class ColorSpace { linear, srgb, oklab };
enum class BasisKind { local, green, exact };
enum class BlendMode { over, multiply, add };
enum class PathKind { polyline, bspline, bezier, circle };

/// Linear RGBA, straight alpha, whatever way the file wrote it.
using Color = Eigen::Vector4d;

/// [x, y, z] (to be snapped) or a face of the mesh with barycentric coordinates.
struct ScenePoint {
    std::string pointer;
    bool on_face = false;
    Eigen::Vector3d position{0, 0, 0};  ///< when !on_face
    int face = -1;                      ///< when on_face: triangle of the selected mesh, in file order
    Eigen::Vector3d bary{0, 0, 0};
};

struct ScenePath {
    std::string pointer;
    PathKind kind = PathKind::polyline;
    std::vector<ScenePoint> points;  ///< control points (not for circles)
    bool closed = false;             ///< true for circles
    int degree = 3;
    bool parameter_curve = false;     ///< "parameter": "curve"; else by arc length
    bool snap_any = false;            ///< "snap": "any"
    ScenePoint center;                ///< circle
    double radius = 0;                ///< circle, in length units
    std::optional<ScenePoint> start;  ///< circle
};

/// Values along a curve at ascending t in [0, 1]. A single value is one stop at t = 0.
template <typename Value>
struct Stops {
    std::vector<double> t;
    std::vector<Value> value;
    bool empty() const { return t.empty(); }
};

/// One side of a diffusion curve. An empty list: open.
struct SideValues {
    Stops<Color> color;
    Stops<double> height;
};

struct DiffusionCurve {
    ScenePath path;
    SideValues left, right;
};

struct PoissonCurve {
    ScenePath path;
    Stops<Eigen::Vector4d> color_jump;  ///< left minus right, in the space of diffusion; alpha 0
    Stops<double> height_jump;
    double width = 0;  ///< of each side's strip, length units
};

struct PoissonRegion {
    ScenePath path;
    bool by_rise = false;                  ///< values are `rise`; else `laplacian`
    std::optional<Eigen::Vector4d> color;  ///< alpha 0
    std::optional<double> height;
    std::optional<double> ring = 0.2;  ///< nullopt: "none"
};

struct Primitive {
    std::string pointer;  ///< "/layers/0/primitives/3"
    std::string id;       ///< may be empty
    bool enabled = true;
    std::variant<DiffusionCurve, PoissonCurve, PoissonRegion> shape;
    /// How messages name it: its id in quotes where it has one, else its pointer.
    std::string name() const;
};

struct Layer {
    std::string pointer;
    std::string name;
    bool on_displaced = false;
    BlendMode blend = BlendMode::over;
    std::vector<Primitive> primitives;
};

struct Scene {
    std::filesystem::path file;              ///< as given by the user, for messages
    std::filesystem::path mesh_file;         ///< resolved against the scene's folder
    std::optional<std::string> mesh_select;  ///< a name, or a number as text
    std::optional<double> max_edge;          ///< length units
    std::optional<int> subdivide;
    bool unit_is_bbox = true;  ///< length_unit "bbox"; else "mesh"
    ColorSpace color_space = ColorSpace::linear;
    double knot_spacing = 0.03;  ///< length units
    double knot_grading = 0.25;
    BasisKind basis = BasisKind::local;
    int basis_rings = 2;
    bool basis_normalize = true;  ///< green: rows divided by their sum
    std::vector<Layer> layers;
    nlohmann::json document;  ///< the file as read (after --set), for embedding
};

/// Reads and checks a scene. Throws Error(bad_input): "FILE: POINTER: expected ..., found ...".
/// assignments: the values of --set, "ID.KEY[.KEY...]=VALUE", applied to the JSON before it is checked (unknown ID:
/// Error(usage)).
Scene read_scene(const std::filesystem::path& file, const std::vector<std::string>& assignments = {});
/// The same from a document already in memory (an embedded scene); file is for messages and relative paths.
Scene parse_scene(const nlohmann::json& document, const std::filesystem::path& file,
                  const std::vector<std::string>& assignments = {});

/// value[0] * weight[0] + value[1] * weight[1] of two stops is the value at t; the second weight is 0 where one stop is all.
struct StopWeights {
    std::array<std::size_t, 2> stop{0, 0};
    std::array<double, 2> weight{1, 0};
};
/// t of the stops, ascending, at least one. Rules as below.
StopWeights stop_weights(const std::vector<double>& stops, double t, bool closed);

/// Value at t: constant beyond the ends of an open curve; periodic on a closed one (t = 0 and 1 both given and
/// different: a jump at the seam, t = 0 wins there).
Color evaluate_stops(const Stops<Color>& stops, double t, bool closed);
double evaluate_stops(const Stops<double>& stops, double t, bool closed);

}  // namespace pvg
