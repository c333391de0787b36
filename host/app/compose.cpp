#include "app/compose.h"

#include <algorithm>
#include <cmath>

#include "scene/color.h"

namespace pvg::app {
namespace {

/// The values of one domain at an output vertex: a row of `channels` floats, or nothing where the domain does not reach.
const float* values_at(const Build& build, const Evaluation& evaluation, int domain, int output_vertex) {
    const int vertex = build.arrangement.domain_vertex[domain][output_vertex];
    if (vertex == none)
        return nullptr;
    const Table& table = build.program.fields[domain].table;
    return evaluation.values[domain].data() + static_cast<std::size_t>(table.vertex_row[vertex]) * table.channels;
}

Color field_color(const float* row, int channel, ColorSpace space) {
    return from_diffusion_space({row[channel], row[channel + 1], row[channel + 2], row[channel + 3]}, space);
}

/// The input's colour at an output vertex, interpolated over the raw face of one of its corners.
Color input_color(const Build& build, const RawMesh& raw, int output_vertex) {
    const Arrangement& a = build.arrangement;
    const int h = a.output.outgoing(output_vertex);
    if (h == none)
        return Color::Ones();
    const int raw_face = build.welded.face_raw[build.map.face[h / 3]];
    const VertexOrigin& origin = build.map.vertex[a.output_parent[output_vertex]];
    Color sum = Color::Zero();
    for (int i = 0; i < 3 && origin.vertex[i] != none; ++i)
        for (int k = 0; k < 3; ++k)
            if (build.welded.raw_to_welded[raw_face][k] == origin.vertex[i]) {
                const auto& c = raw.colors[raw.faces[raw_face][k]];
                sum += origin.weight[i] * Color(c[0], c[1], c[2], c[3]);
            }
    return sum;
}

void compose_fields(const Scene& scene, const RawMesh& raw, const Build& build, const Evaluation& evaluation,
                    DecoratedMesh& mesh) {
    const Arrangement& a = build.arrangement;
    const int n = a.output.vertex_count();
    mesh.decorated.assign(n, 0);
    mesh.color_decorated.assign(n, 0);
    mesh.color.assign(n, {1, 1, 1, 1});
    mesh.field_color.assign(n, {0, 0, 0, 0});
    mesh.field_height = evaluation.height;
    mesh.dirichlet.assign(n, {0, 0});
    mesh.cell.assign(n, {-1, -1});
    for (int v = 0; v < n; ++v) {
        Color color = Color::Zero();  // of the layers alone
        Color shown = Color::Zero();  // over the input
        for (std::size_t l = 0; l < a.layers.size(); ++l) {
            const LayerFields& fields = a.layers[l];
            for (int part = 0; part < 2; ++part) {
                const int domain = part == 0 ? fields.color_domain : fields.height_domain;
                if (domain == none)
                    continue;
                const float* row = values_at(build, evaluation, domain, v);
                if (!row)
                    continue;
                const int vertex = a.domain_vertex[domain][v];
                mesh.decorated[v] = 1;
                if (a.domains[domain].dirichlet[vertex])
                    mesh.dirichlet[v][part] = 1;
                mesh.cell[v][part] = static_cast<float>(build.domains[domain].voronoi.cell[vertex]);
                if (part == 1)
                    continue;
                const Color value = field_color(row, fields.color_channel, scene.color_space);
                if (!mesh.color_decorated[v]) {
                    shown = input_color(build, raw, v);
                    color = value;
                } else {
                    color = blend_colors(color, value, scene.layers[l].blend);
                }
                const Color clamped = value.cwiseMax(0).cwiseMin(1);
                shown = blend_colors(shown, clamped, scene.layers[l].blend);
                mesh.color_decorated[v] = 1;
            }
        }
        for (int c = 0; c < 4; ++c) {
            mesh.field_color[v][c] = static_cast<float>(color[c]);
            if (mesh.color_decorated[v])
                mesh.color[v][c] = static_cast<float>(shown[c]);
        }
    }
}

/// Two triangles between the sides of each slit edge whose heights differ; one where they differ at one end only.
void raise_walls(const Build& build, DecoratedMesh& mesh) {
    const auto at = [&](int v) { return Point(mesh.position[v][0], mesh.position[v][1], mesh.position[v][2]); };
    const auto add = [&](int a, int b, int c, int raw_face) {
        const Point normal = (at(b) - at(a)).cross(at(c) - at(a));
        const double size = normal.norm();
        if (!(size > 0))
            return;
        mesh.walls.push_back(
            {{a, b, c},
             {static_cast<float>(normal[0] / size), static_cast<float>(normal[1] / size), static_cast<float>(normal[2] / size)},
             raw_face});
    };
    for (const SlitEdge& edge : build.arrangement.height_slits) {
        if (edge.left_face == none || edge.right_face == none)
            continue;  // on a border there is nothing to close
        const int raw_face = build.welded.face_raw[build.map.face[edge.left_face]];
        const auto [l0, l1] = edge.left;
        const auto [r0, r1] = edge.right;
        // The left face runs l0 -> l1 along this edge, so the wall's boundary runs l1 -> l0 and r0 -> r1.
        if (mesh.position[l1] != mesh.position[r1])
            add(l1, l0, r1, raw_face);
        if (mesh.position[l0] != mesh.position[r0])
            add(l0, r0, r1, raw_face);
    }
}

}  // namespace

DecoratedMesh compose(const Scene& scene, const RawMesh& raw, const Build& build, const Evaluation& evaluation,
                      const ComposeOptions& options) {
    const Arrangement& a = build.arrangement;
    const int n = a.output.vertex_count();
    DecoratedMesh mesh;
    mesh.base = build.program.base;
    mesh.origin.reserve(n);
    for (int v = 0; v < n; ++v) mesh.origin.push_back(build.map.vertex[a.output_parent[v]]);
    compose_fields(scene, raw, build, evaluation, mesh);

    mesh.faces = a.output.faces();
    mesh.raw_face.reserve(mesh.faces.size());
    for (int f = 0; f < a.output.face_count(); ++f) mesh.raw_face.push_back(build.welded.face_raw[build.map.face[f]]);
    mesh.position = evaluation.position;
    mesh.normals = evaluation.normal;
    mesh.moved.assign(n, 0);
    for (int v = 0; v < n; ++v) mesh.moved[v] = mesh.position[v] != mesh.base[v];
    // Without displacement the surface is the input's, and so are its normals where it has some.
    mesh.corner_normal = build.corner_normal;
    if (!options.displace && !raw.normals.empty())
        mesh.corner_normal.assign(mesh.faces.size(), Face{none, none, none});
    if (options.displace)
        raise_walls(build, mesh);
    return mesh;
}

}  // namespace pvg::app
