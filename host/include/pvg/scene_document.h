// A scene that is being edited: loaded once, changed by calls, always solved. Each edit does the least work that it asks for and
// says what an evaluator must be given anew:
//
//     auto document = pvg::SceneDocument::open("logo.pvg.json");
//     evaluator.load(document.value().program());
//     auto change = document.value().set_color("rim", pvg::Part::left, 0, {1, 0.2, 0, 1});
//     for (std::uint32_t f : change.value().fields)
//         evaluator.set_coefficients(f, document.value().program().fields[f].coefficients);
//
// The state is a function of the scene alone: whatever edits led to it, undone ones included, a document that is opened with the
// same scene holds the same geometry bit for bit, and coefficients that differ by no more than what the solver leaves (1e-5 of
// their range). A call that fails changes nothing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pvg/program.h"
#include "pvg/status.h"

namespace pvg {

/// The values of a primitive: a diffusion curve's sides, a Poisson curve's jump, a Poisson region's "laplacian" or "rise".
enum class Part { left, right, jump, region };

/// A stop of a list along a curve. t in [0, 1], ascending over a list. color: linear RGBA on sides; RGB differences in the space
/// of diffusion on jumps (the fourth number is not read).
struct ValueStop {
    double t = 0;
    std::optional<std::array<double, 4>> color;
    std::optional<double> height;
};

/// A triangle mesh in memory. normals: as many as points, or none.
struct MeshData {
    std::vector<std::array<float, 3>> points;
    std::vector<std::array<float, 3>> normals;
    std::vector<std::array<std::uint32_t, 3>> faces;
};

struct DocumentOptions {
    int threads = 0;               ///< of builds; 0: all cores. Results do not depend on it.
    std::size_t undo_limit = 256;  ///< steps kept; older ones are forgotten
    /// Called on the calling thread as each stage of a build begins ("curves", "knots", "voronoi", "system", "basis").
    std::function<void(const std::string&)> on_stage = {};
};

/// What a call changed.
struct Change {
    bool rebuilt = false;               ///< the geometry is new: load program() and output() again
    std::vector<std::uint32_t> fields;  ///< whose coefficients are new, ascending; all of them when rebuilt
    Warnings warnings;                  ///< of the build
};

/// What to draw: n output vertices, those of program(). All indices are into it.
struct OutputSurface {
    static constexpr std::uint32_t no_row = 0xffffffff;
    /// A layer's colour at output vertex i: the four values from `channel` of row `row[i]` of field `field`, in the space of
    /// diffusion, straight alpha. Layers stand bottom up.
    struct ColorLayer {
        std::uint32_t field = 0;
        std::uint32_t channel = 0;
        std::vector<std::uint32_t> row;  ///< n: no_row where the layer has no colour
        std::string blend;               ///< "over", "multiply" or "add"
    };
    std::vector<std::array<std::uint32_t, 3>> faces;
    std::vector<std::array<std::uint32_t, 3>> corner_normal;  ///< per face and corner: shading normal of program(), or no_row
    std::vector<ColorLayer> color_layers;
    std::string color_space;  ///< "linear", "srgb" or "oklab"
};

/// Owns all that it holds; not thread-safe, no global state. References that it hands out live until the next call that is not
/// const.
class SceneDocument {
public:
    /// A scene file with its mesh. Error(bad_input) as `pvg decorate` would give it.
    static Result<SceneDocument> open(const std::filesystem::path& scene, const DocumentOptions& options = {});
    /// A scene as JSON text on a mesh in memory ("mesh.file" is not read). name: what messages call the scene.
    static Result<SceneDocument> create(const std::string& scene, const MeshData& mesh, const std::string& name = "scene",
                                        const DocumentOptions& options = {});
    ~SceneDocument();
    SceneDocument(SceneDocument&&) noexcept;
    SceneDocument& operator=(SceneDocument&&) noexcept;

    /// Coefficients in it are those of the scene now.
    const Program& program() const;
    const OutputSurface& output() const;
    std::size_t knot_count() const;
    /// Of the last build; after open, also of reading the mesh.
    const Warnings& warnings() const;
    /// The scene now, as a scene file holds it.
    std::string scene() const;

    // Values. primitive: an id, or a JSON pointer ("/layers/0/primitives/2"). stop: its place in the scene's list, 0 where there
    // is no list. The first edit of a stop solves for its response, further ones reuse it; see prepare().

    Result<Change> set_color(const std::string& primitive, Part part, std::size_t stop, const std::array<double, 4>& color);
    Result<Change> set_height(const std::string& primitive, Part part, std::size_t stop, double height);
    /// Replaces the list. New parameters build anew, because a curve has a vertex at each stop; but within a group, on diffusion
    /// curves and sharp Poisson curves that keep their quantities, the values move over the vertices there are and the build
    /// waits for the end of the group.
    Result<Change> set_stops(const std::string& primitive, Part part, const std::vector<ValueStop>& stops);
    /// A region's "laplacian" (or "rise", where the scene has that): what is nullopt stays.
    Result<Change> set_laplacian(const std::string& primitive, const std::optional<std::array<double, 3>>& color,
                                 const std::optional<double>& height);

    // Shapes: these build anew.

    /// point: a control point's place in "points"; of a circle 0, its centre.
    Result<Change> move_point(const std::string& primitive, std::size_t point, const std::array<double, 3>& position);
    /// primitive: JSON text as in a scene file. at: its place in the layer, at the end where nullopt.
    Result<Change> add(std::size_t layer, const std::string& primitive, std::optional<std::size_t> at = {});
    Result<Change> remove(const std::string& primitive);
    Result<Change> enable(const std::string& primitive, bool enabled);
    /// Anything else: "ID.KEY[.KEY...]=VALUE", as --set on the command line. As cheap as what it changes.
    Result<Change> set(const std::string& assignment);

    // History. Edits between begin_group and end_group (as while the mouse is down) are one step. Groups do not nest.

    void begin_group();
    /// Builds what was put off (set_stops). After an Error the scene is the edited one, shown as it was in the group.
    Result<Change> end_group();
    bool can_undo() const;
    bool can_redo() const;
    /// Error(usage) when there is nothing to undo or redo.
    Result<Change> undo();
    Result<Change> redo();

    /// Solves for the responses of all values now, so that no later edit of a value waits for one. Returns how many were missing.
    Result<int> prepare();

private:
    SceneDocument();
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace pvg
