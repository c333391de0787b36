#include "pvg/scene_document.h"

#include <algorithm>
#include <deque>
#include <limits>
#include <utility>

#include "curves/controls.h"
#include "document/output_surface.h"
#include "document/scene_edits.h"
#include "gltf/asset.h"
#include "scene/assign.h"
#include "scene/compare.h"
#include "scene/json_text.h"
#include "scene/scene.h"
#include "solve/build.h"
#include "solve/responses.h"

namespace pvg {

using nlohmann::json;

namespace {

/// A build and what makes its values editable. Responses refer into the build, so it stays where it is.
struct Solved {
    Build build;
    OutputSurface output;
    std::vector<std::unique_ptr<Responses>> responses;  // per domain, null where the basis is not the local one
    std::vector<std::vector<Control>> controls;         // per domain: with the values that its coefficients are of

    Solved(const Scene& scene, const MeshInput& mesh, const BuildOptions& options, Warnings& warnings)
        : build(pvg::build(scene, mesh, options, warnings)), output(output_surface(scene, build)) {
        for (std::size_t d = 0; d < build.domains.size(); ++d) {
            const Domain& domain = build.arrangement.domains[d];
            const SolvedDomain& solved = build.domains[d];
            controls.push_back(domain.controls);
            responses.push_back(scene.basis == BasisKind::local
                                    ? std::make_unique<Responses>(domain, solved.knots, solved.system, solved.matrix,
                                                                  build.program.fields[d].table, solved.unbounded)
                                    : nullptr);
        }
    }
    Solved(const Solved&) = delete;
    Solved& operator=(const Solved&) = delete;

    /// The controls as the scene, of the same geometry, has them now; nullopt where that asks for a build after all.
    std::optional<std::vector<std::vector<Control>>> controls_now(const Scene& scene) const {
        std::vector<std::vector<Control>> now;
        for (const Domain& domain : build.arrangement.domains) {
            now.push_back(controls_of(scene, domain));
            for (const Control& control : now.back())
                if (control.t.empty() || (!control.reached && !control.value.isZero(0)))
                    return std::nullopt;
        }
        return now;
    }

    /// The fields whose coefficients changed.
    std::vector<std::uint32_t> set_controls(const Scene& scene, std::vector<std::vector<Control>> now) {
        const auto same = [](const Control& a, const Control& b) { return a.t == b.t && a.value == b.value; };
        std::vector<std::uint32_t> changed;
        std::vector<std::vector<float>> coefficients;
        for (std::size_t d = 0; d < now.size(); ++d) {
            if (std::equal(now[d].begin(), now[d].end(), controls[d].begin(), controls[d].end(), same))
                continue;
            coefficients.push_back(responses[d] ? responses[d]->coefficients(now[d]) : solve_anew(scene, d, now[d]));
            changed.push_back(static_cast<std::uint32_t>(d));
        }
        // Nothing throws from here on.
        for (std::size_t i = 0; i < changed.size(); ++i) {
            build.program.fields[changed[i]].coefficients = std::move(coefficients[i]);
            controls[changed[i]] = std::move(now[changed[i]]);
        }
        return changed;
    }

private:
    std::vector<float> solve_anew(const Scene& scene, std::size_t d, const std::vector<Control>& values) {
        Domain& domain = build.arrangement.domains[d];
        domain.controls = values;
        apply_controls(domain);
        SolvedDomain& solved = build.domains[d];
        const PatchSpace space(domain, solved.knots, solved.voronoi);
        solved.cell_lambda = solved.system.solve(domain);
        Coefficients coefficients = solve_coefficients(space, solved.voronoi, solved.system, build.program.fields[d].table,
                                                       basis_choice(scene), solved.cell_lambda);
        solved.lambda = std::move(coefficients.lambda);
        return std::move(coefficients.values);
    }
};

}  // namespace

struct SceneDocument::State {
    DocumentOptions options;
    RawMesh mesh;
    Scene scene;  // scene.document is the JSON
    Scene built;  // what the geometry was made for; while a group is open, stops may have moved since
    std::unique_ptr<Solved> solved;
    Warnings warnings;            // of the last build
    std::deque<json> undo, redo;  // patches from the scene as it then stands to the one before or after
    std::optional<json> group;    // the scene as it was when the group began

    std::unique_ptr<Solved> solve(const Scene& of, Warnings& found) const {
        BuildOptions build_options;
        build_options.threads = options.threads;
        build_options.keep_forms = true;
        build_options.on_stage = options.on_stage;
        return std::make_unique<Solved>(of, MeshInput{mesh.points, mesh.normals, mesh.faces}, build_options, found);
    }

    /// Makes the scene this one. Throws and changes nothing when it cannot be.
    Change become(const json& document) {
        Scene next = parse_scene(document, scene.file);
        if (next.mesh_file != scene.mesh_file || next.mesh_select != scene.mesh_select)
            throw Error(ErrorKind::usage,
                        scene.file.string() + ": /mesh: another mesh needs another document; expected an edit of the same mesh");
        Change change;
        std::optional<std::vector<std::vector<Control>>> now;
        if (same_geometry(built, next) && (group || same_stops(built, next)))
            now = solved->controls_now(next);
        if (now) {
            change.fields = solved->set_controls(next, std::move(*now));
            for (std::size_t l = 0, k = 0; l < next.layers.size(); ++l)
                if (solved->build.arrangement.layers[l].color_domain != none)
                    solved->output.color_layers[k++].blend = word(next.layers[l].blend);
            solved->output.color_space = word(next.color_space);
        } else {
            solved = solve(next, change.warnings);
            built = next;
            warnings = change.warnings;
            change.rebuilt = true;
            for (std::uint32_t f = 0; f < solved->build.program.fields.size(); ++f) change.fields.push_back(f);
        }
        scene = std::move(next);
        return change;
    }

    void remember(const json& before) {
        if (group || before == scene.document)
            return;
        undo.push_back(json::diff(scene.document, before));
        redo.clear();
        while (undo.size() > options.undo_limit) undo.pop_front();
    }

    /// edit changes the JSON in place.
    template <typename Edit>
    Result<Change> apply(const Edit& edit) {
        try {
            json next = scene.document;
            edit(next);
            const json before = scene.document;
            Change change = become(next);
            remember(before);
            return change;
        } catch (const Error& error) {
            return error;
        }
    }

    Result<Change> travel(std::deque<json>& from, std::deque<json>& to, const char* what) {
        if (group)
            return Error(ErrorKind::usage, std::string("a group of edits is open: end it before you ") + what);
        if (from.empty())
            return Error(ErrorKind::usage, std::string("there is nothing to ") + what);
        try {
            const json before = scene.document;
            Change change = become(before.patch(from.back()));
            from.pop_back();
            to.push_back(json::diff(scene.document, before));
            return change;
        } catch (const Error& error) {
            return error;
        }
    }
};

SceneDocument::SceneDocument() : state_(std::make_unique<State>()) {}
SceneDocument::~SceneDocument() = default;
SceneDocument::SceneDocument(SceneDocument&&) noexcept = default;
SceneDocument& SceneDocument::operator=(SceneDocument&&) noexcept = default;

Result<SceneDocument> SceneDocument::open(const std::filesystem::path& scene, const DocumentOptions& options) {
    try {
        SceneDocument document;
        State& s = *document.state_;
        s.options = options;
        s.scene = read_scene(scene);
        s.mesh = MeshAsset::read(s.scene.mesh_file, s.scene.mesh_select, s.warnings).mesh();
        s.solved = s.solve(s.scene, s.warnings);
        s.built = s.scene;
        return document;
    } catch (const Error& error) {
        return error;
    }
}

Result<SceneDocument> SceneDocument::create(const std::string& scene, const MeshData& mesh, const std::string& name,
                                            const DocumentOptions& options) {
    try {
        constexpr std::uint32_t most = std::numeric_limits<int>::max();
        if (!mesh.normals.empty() && mesh.normals.size() != mesh.points.size())
            throw Error(ErrorKind::usage, name + ": the mesh has " + std::to_string(mesh.normals.size()) +
                                              " normals, expected none or as many as points, " +
                                              std::to_string(mesh.points.size()));
        SceneDocument document;
        State& s = *document.state_;
        s.options = options;
        s.scene = parse_scene(parse_json_text(scene, name), name);
        for (const auto& p : mesh.points) s.mesh.points.emplace_back(p[0], p[1], p[2]);
        for (const auto& p : mesh.normals) s.mesh.normals.emplace_back(p[0], p[1], p[2]);
        for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
            for (std::uint32_t v : mesh.faces[f])
                if (v >= mesh.points.size() || v > most)
                    throw Error(ErrorKind::usage, name + ": face " + std::to_string(f) + " of the mesh names point " +
                                                      std::to_string(v) + ", expected below " +
                                                      std::to_string(mesh.points.size()));
            const auto& [a, b, c] = mesh.faces[f];
            s.mesh.faces.push_back({static_cast<int>(a), static_cast<int>(b), static_cast<int>(c)});
        }
        s.solved = s.solve(s.scene, s.warnings);
        s.built = s.scene;
        return document;
    } catch (const Error& error) {
        return error;
    }
}

const Program& SceneDocument::program() const { return state_->solved->build.program; }
const OutputSurface& SceneDocument::output() const { return state_->solved->output; }

std::size_t SceneDocument::knot_count() const {
    std::size_t count = 0;
    for (const SolvedDomain& domain : state_->solved->build.domains) count += domain.knots.vertex.size();
    return count;
}

const Warnings& SceneDocument::warnings() const { return state_->warnings; }

std::string SceneDocument::scene() const { return state_->scene.document.dump(2); }

Result<Change> SceneDocument::set_color(const std::string& primitive, Part part, std::size_t stop,
                                        const std::array<double, 4>& color) {
    return state_->apply([&](json& document) {
        json& place = find_primitive(document, primitive, state_->scene.file.string());
        find_stop(place, part, stop, primitive)["color"] = written_color(part, color);
    });
}

Result<Change> SceneDocument::set_height(const std::string& primitive, Part part, std::size_t stop, double height) {
    return state_->apply([&](json& document) {
        json& place = find_primitive(document, primitive, state_->scene.file.string());
        find_stop(place, part, stop, primitive)["height"] = height;
    });
}

Result<Change> SceneDocument::set_stops(const std::string& primitive, Part part, const std::vector<ValueStop>& stops) {
    return state_->apply([&](json& document) {
        replace_stops(find_primitive(document, primitive, state_->scene.file.string()), part, stops, primitive);
    });
}

Result<Change> SceneDocument::set_laplacian(const std::string& primitive, const std::optional<std::array<double, 3>>& color,
                                            const std::optional<double>& height) {
    return state_->apply([&](json& document) {
        json& place = find_primitive(document, primitive, state_->scene.file.string());
        json& value = find_stop(place, Part::region, 0, primitive);
        if (color)
            value["color"] = *color;
        if (height)
            value["height"] = *height;
    });
}

Result<Change> SceneDocument::move_point(const std::string& primitive, std::size_t point, const std::array<double, 3>& position) {
    return state_->apply([&](json& document) {
        move_control_point(find_primitive(document, primitive, state_->scene.file.string()), point, position, primitive);
    });
}

Result<Change> SceneDocument::add(std::size_t layer, const std::string& primitive, std::optional<std::size_t> at) {
    return state_->apply([&](json& document) { add_primitive(document, layer, primitive, at); });
}

Result<Change> SceneDocument::remove(const std::string& primitive) {
    return state_->apply([&](json& document) { remove_primitive(document, primitive, state_->scene.file.string()); });
}

Result<Change> SceneDocument::enable(const std::string& primitive, bool enabled) {
    return state_->apply(
        [&](json& document) { find_primitive(document, primitive, state_->scene.file.string())["enabled"] = enabled; });
}

Result<Change> SceneDocument::set(const std::string& assignment) {
    return state_->apply([&](json& document) { apply_assignment(document, assignment, state_->scene.file.string()); });
}

void SceneDocument::begin_group() {
    if (!state_->group)
        state_->group = state_->scene.document;
}

Result<Change> SceneDocument::end_group() {
    State& s = *state_;
    if (!s.group)
        return Change{};
    const json before = std::move(*s.group);
    s.group.reset();
    s.remember(before);
    try {
        return s.become(s.scene.document);
    } catch (const Error& error) {
        return error;
    }
}

bool SceneDocument::can_undo() const { return !state_->undo.empty() && !state_->group; }
bool SceneDocument::can_redo() const { return !state_->redo.empty() && !state_->group; }
Result<Change> SceneDocument::undo() { return state_->travel(state_->undo, state_->redo, "undo"); }
Result<Change> SceneDocument::redo() { return state_->travel(state_->redo, state_->undo, "redo"); }

Result<int> SceneDocument::prepare() {
    int solved = 0;
    for (const auto& responses : state_->solved->responses)
        if (responses)
            solved += responses->prepare_all();
    return solved;
}

}  // namespace pvg
