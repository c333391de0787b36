#include "solve/normals.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace pvg {
namespace {

constexpr double crease_cosine = 0.766;        // 40 degrees
constexpr double same_normal_cosine = 0.9999;  // 0.8 degrees: files store normals in floats or bytes

int find_root(std::vector<int>& parent, int at) {
    while (parent[at] != at) at = parent[at] = parent[parent[at]];
    return at;
}

}  // namespace

std::vector<Point> corner_input_normals(const Arrangement& arrangement, const SurfaceMap& map,
                                        std::span<const int> welded_face_raw, std::span<const Face> raw_faces,
                                        std::span<const Face> raw_to_welded, std::span<const Point> raw_normals) {
    if (raw_normals.empty())
        return {};
    const Surface& output = arrangement.output;
    std::vector<Point> normals(output.halfedge_count(), Point::Zero());
    for (int h = 0; h < output.halfedge_count(); ++h) {
        const int raw = welded_face_raw[map.face[h / 3]];
        const VertexOrigin& origin = map.vertex[arrangement.output_parent[output.origin(h)]];
        Point& sum = normals[h];
        for (int i = 0; i < 3 && origin.vertex[i] != none; ++i)
            for (int k = 0; k < 3; ++k)
                if (raw_to_welded[raw][k] == origin.vertex[i])
                    sum += origin.weight[i] * raw_normals[raw_faces[raw][k]];
        const double size = sum.norm();
        if (size > 0)
            sum /= size;
    }
    return normals;
}

std::vector<int> shading_groups(const Arrangement& arrangement, std::span<const Point> input_normals, int* count) {
    const Surface& surface = arrangement.imprinted.surface;  // unslit: colour slits do not crease the shading
    std::vector<char> height_slit(surface.halfedge_count(), 0);
    for (const SlitEdge& edge : arrangement.height_slits) {
        for (const auto& [face, from, to] : {std::array<int, 3>{edge.left_face, edge.left[0], edge.left[1]},
                                             std::array<int, 3>{edge.right_face, edge.right[1], edge.right[0]}}) {
            if (face == none)
                continue;
            for (int k = 0; k < 3; ++k) {
                const int h = 3 * face + k;
                if (arrangement.output.origin(h) == from && arrangement.output.target(h) == to)
                    height_slit[h] = 1;
            }
        }
    }

    std::vector<int> parent(surface.halfedge_count());
    std::iota(parent.begin(), parent.end(), 0);
    const auto join = [&](int a, int b) {
        a = find_root(parent, a);
        b = find_root(parent, b);
        if (a != b)
            parent[std::max(a, b)] = std::min(a, b);
    };
    const auto smooth = [&](int corner_a, int corner_b) {
        return input_normals.empty() || input_normals[corner_a].dot(input_normals[corner_b]) > same_normal_cosine;
    };
    for (int h = 0; h < surface.halfedge_count(); ++h) {
        const int t = surface.twin(h);
        if (t == none || t < h || height_slit[h] || height_slit[t])
            continue;
        if (input_normals.empty() && surface.face_normal(h / 3).dot(surface.face_normal(t / 3)) < crease_cosine)
            continue;
        if (smooth(h, Surface::next(t)))
            join(h, Surface::next(t));
        if (smooth(Surface::next(h), t))
            join(Surface::next(h), t);
    }

    std::vector<int> group(surface.halfedge_count(), none);
    int groups = 0;
    for (int h = 0; h < surface.halfedge_count(); ++h) {
        const int root = find_root(parent, h);
        if (group[root] == none)
            group[root] = groups++;
        group[h] = group[root];
    }
    if (count)
        *count = groups;
    return group;
}

}  // namespace pvg
