#include "solve/build.h"

#include <chrono>
#include <cmath>

#include "mesh/subdivide.h"
#include "solve/field.h"
#include "solve/normals.h"

namespace pvg {
namespace {

class StageClock {
public:
    StageClock(const BuildOptions& options, Build& result) : options_(options), result_(result) {}
    void enter(const std::string& stage) {
        leave();
        stage_ = stage;
        started_ = std::chrono::steady_clock::now();
        if (options_.on_stage)
            options_.on_stage(stage);
    }
    void leave() {
        if (stage_.empty())
            return;
        const double spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
        for (auto& [name, seconds] : result_.seconds)
            if (name == stage_) {
                seconds += spent;
                stage_.clear();
                return;
            }
        result_.seconds.emplace_back(stage_, spent);
        stage_.clear();
    }

private:
    const BuildOptions& options_;
    Build& result_;
    std::string stage_;
    std::chrono::steady_clock::time_point started_;
};

RefinedSurface prepare_base(const Scene& scene, const Surface& welded, double unit) {
    if (scene.max_edge)
        return subdivide_to(welded, *scene.max_edge * unit);
    if (scene.subdivide)
        return subdivide(welded, *scene.subdivide);
    return {welded, identity_map(welded)};
}

std::array<float, 3> to_float(const Point& p) {
    return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
}

/// Displacement directions of the output vertices: the welded input's angle-weighted normals, interpolated, so that
/// vertices made by subdivision and imprinting move like their surroundings.
std::vector<std::array<float, 3>> displacement_normals(const Build& b) {
    const std::vector<Point> welded = vertex_normals(b.welded.surface);
    const std::vector<Point> own = vertex_normals(b.arrangement.imprinted.surface);
    std::vector<std::array<float, 3>> normals(b.arrangement.output.vertex_count());
    for (int v = 0; v < b.arrangement.output.vertex_count(); ++v) {
        const int parent = b.arrangement.output_parent[v];
        const VertexOrigin& origin = b.map.vertex[parent];
        Point sum = Point::Zero();
        for (int i = 0; i < 3 && origin.vertex[i] != none; ++i) sum += origin.weight[i] * welded[origin.vertex[i]];
        const double size = sum.norm();
        normals[v] = to_float(size > 1e-6 ? Point(sum / size) : own[parent]);
    }
    return normals;
}

void fill_heights(Build& b) {
    Program& program = b.program;
    const Arrangement& a = b.arrangement;
    program.height_first.assign(1, 0);
    for (int v = 0; v < a.output.vertex_count(); ++v) {
        for (const LayerFields& layer : a.layers) {
            if (layer.height_domain == none)
                continue;
            const int vertex = a.domain_vertex[layer.height_domain][v];
            if (vertex == none)
                continue;
            program.height_terms.push_back({static_cast<std::uint32_t>(layer.height_domain),
                                            program.fields[layer.height_domain].table.vertex_row[vertex],
                                            static_cast<std::uint32_t>(layer.height_channel)});
        }
        program.height_first.push_back(static_cast<std::uint32_t>(program.height_terms.size()));
    }
}

/// Shading normals for the groups of corners that a height can turn.
void fill_normals(Build& b, const MeshInput& mesh) {
    const Arrangement& a = b.arrangement;
    const std::vector<Point> input =
        corner_input_normals(a, b.map, b.welded.face_raw, mesh.faces, b.welded.raw_to_welded, mesh.normals);
    int groups = 0;
    const std::vector<int> group = shading_groups(a, input, &groups);

    std::vector<char> needed(groups, mesh.normals.empty() ? 1 : 0);
    const auto moves = [&](int v) { return b.program.height_first[v + 1] > b.program.height_first[v]; };
    for (int h = 0; h < a.output.halfedge_count(); ++h) {
        const Face& face = a.output.face(h / 3);
        if (moves(face[0]) || moves(face[1]) || moves(face[2]))
            needed[group[h]] = 1;
    }
    std::vector<int> number(groups, none);
    int count = 0;
    for (int g = 0; g < groups; ++g)
        if (needed[g])
            number[g] = count++;

    std::vector<std::uint32_t> first(count + 1, 0);
    for (int h = 0; h < a.output.halfedge_count(); ++h)
        if (number[group[h]] != none)
            ++first[number[group[h]] + 1];
    for (int g = 0; g < count; ++g) first[g + 1] += first[g];
    std::vector<std::uint32_t> fill(first.begin(), first.end());
    b.program.corners.resize(first[count]);
    b.corner_normal.assign(a.output.face_count(), Face{none, none, none});
    for (int h = 0; h < a.output.halfedge_count(); ++h) {
        const int g = number[group[h]];
        if (g == none)
            continue;
        b.corner_normal[h / 3][h % 3] = g;
        b.program.corners[fill[g]++] = {static_cast<std::uint32_t>(a.output.origin(h)),
                                        static_cast<std::uint32_t>(a.output.target(h)),
                                        static_cast<std::uint32_t>(a.output.origin(Surface::prev(h)))};
    }
    b.program.corner_first = std::move(first);
}

}  // namespace

BasisChoice basis_choice(const Scene& scene) { return {scene.basis, scene.basis_rings, scene.basis_normalize}; }

Build build(const Scene& scene, const MeshInput& mesh, const BuildOptions& options, Warnings& warnings) {
    Build b;
    StageClock clock(options, b);

    clock.enter("curves");
    b.welded = weld(mesh.points, mesh.faces, warnings);
    if (b.welded.surface.face_count() == 0)
        throw Error(ErrorKind::bad_input,
                    scene.mesh_file.string() + ": the mesh has no triangle with an area, nothing to draw on");
    b.unit = length_unit(scene, b.welded.surface);
    {
        BaseSurface base;
        base.welded = b.welded.surface;
        base.face_raw = b.welded.face_raw;
        base.non_manifold_edges = b.welded.non_manifold_edges;
        RefinedSurface refined = prepare_base(scene, base.welded, b.unit);
        base.surface = std::move(refined.surface);
        base.map = std::move(refined.map);
        b.base_map = base.map;
        b.arrangement = arrange(scene, base, warnings);
    }
    b.map = compose(b.base_map, b.arrangement.imprinted.map);

    for (const Domain& domain : b.arrangement.domains) {
        clock.enter("knots");
        Knots knots = place_knots(domain, {.spacing = scene.knot_spacing * b.unit, .grading = scene.knot_grading});
        clock.enter("voronoi");
        Voronoi voronoi = geodesic_voronoi(domain, knots);
        clock.enter("system");
        System system(domain, knots, voronoi);
        Eigen::MatrixXd cell_lambda = system.solve(domain);
        clock.enter("basis");
        PatchSpace space(domain, knots, voronoi);
        Field field;
        field.table = basis_table(space, voronoi, basis_choice(scene), {options.threads, options.on_progress});
        clock.enter("system");
        Coefficients solved =
            solve_coefficients(space, voronoi, system, field.table, basis_choice(scene), cell_lambda, options.threads);
        field.coefficients = std::move(solved.values);
        b.program.fields.push_back(std::move(field));
        SolvedDomain& kept = b.domains.emplace_back(
            SolvedDomain{{}, std::move(voronoi), std::move(system), std::move(cell_lambda), std::move(solved.lambda), {}, {}});
        if (options.keep_forms) {
            kept.unbounded = std::move(solved.unbounded);
            kept.matrix = std::move(solved.matrix);
        }
        kept.knots = std::move(knots);
    }

    clock.enter("basis");
    b.program.unit = static_cast<float>(b.unit);
    b.program.base.reserve(b.arrangement.output.vertex_count());
    for (const Point& p : b.arrangement.output.points()) b.program.base.push_back(to_float(p));
    b.program.normal = displacement_normals(b);
    fill_heights(b);
    fill_normals(b, mesh);
    clock.leave();
    const Result<bool> valid = validate(b.program);
    if (!valid)
        throw Error(valid.error());
    return b;
}

}  // namespace pvg
