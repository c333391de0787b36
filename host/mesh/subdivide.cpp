#include "mesh/subdivide.h"

#include <cmath>
#include <string>
#include <vector>

#include "pvg/status.h"

namespace pvg {
namespace {

constexpr double vertex_limit = 50e6;

[[noreturn]] void refuse(double predicted) {
    throw Error(ErrorKind::bad_input, "subdivision would make about " + std::to_string(static_cast<long long>(predicted)) +
                                          " vertices, more than the 50 million that fit; use a larger max_edge or fewer levels");
}

/// Splits the marked edges (per halfedge; twins agree) at their midpoints: triangles into 1, 2, 3 or 4.
RefinedSurface split_edges(const Surface& surface, const std::vector<char>& marked) {
    std::vector<Point> points = surface.points();
    SurfaceMap map = identity_map(surface);
    std::vector<int> middle(surface.halfedge_count(), none);
    for (int h = 0; h < surface.halfedge_count(); ++h) {
        if (!marked[h] || middle[h] != none)
            continue;
        const int a = surface.origin(h), b = surface.target(h);
        middle[h] = static_cast<int>(points.size());
        if (surface.twin(h) != none)
            middle[surface.twin(h)] = middle[h];
        points.push_back(0.5 * (surface.point(a) + surface.point(b)));
        map.vertex.push_back({{a, b, none}, {0.5, 0.5, 0}});
    }

    std::vector<Face> faces;
    std::vector<int> parent;
    const auto add = [&](int a, int b, int c, int from) {
        faces.push_back({a, b, c});
        parent.push_back(from);
    };
    for (int f = 0; f < surface.face_count(); ++f) {
        const std::array<int, 3> mid{middle[3 * f], middle[3 * f + 1], middle[3 * f + 2]};
        const int splits = (mid[0] != none) + (mid[1] != none) + (mid[2] != none);
        const Face& v = surface.face(f);
        if (splits == 0) {
            add(v[0], v[1], v[2], f);
        } else if (splits == 3) {
            add(v[0], mid[0], mid[2], f);
            add(mid[0], v[1], mid[1], f);
            add(mid[2], mid[1], v[2], f);
            add(mid[0], mid[1], mid[2], f);
        } else if (splits == 1) {
            const int k = mid[0] != none ? 0 : mid[1] != none ? 1 : 2;
            const int a = v[k], b = v[(k + 1) % 3], c = v[(k + 2) % 3];
            add(a, mid[k], c, f);
            add(mid[k], b, c, f);
        } else {
            // Corner b lies between the two split edges; the remaining quad takes its shorter diagonal.
            const int k = mid[0] == none ? 1 : mid[1] == none ? 2 : 0;
            const int a = v[k], b = v[(k + 1) % 3], c = v[(k + 2) % 3];
            const int ab = mid[k], bc = mid[(k + 1) % 3];
            add(ab, b, bc, f);
            if ((points[ab] - points[c]).squaredNorm() <= (points[a] - points[bc]).squaredNorm()) {
                add(a, ab, c, f);
                add(ab, bc, c, f);
            } else {
                add(a, ab, bc, f);
                add(a, bc, c, f);
            }
        }
    }
    map.face = std::move(parent);
    return {Surface(std::move(points), std::move(faces)), std::move(map)};
}

}  // namespace

RefinedSurface subdivide(const Surface& surface, int levels) {
    const double predicted = surface.vertex_count() + surface.face_count() * (std::pow(4.0, levels) - 1) / 2;
    if (predicted > vertex_limit)
        refuse(predicted);
    RefinedSurface result{surface, identity_map(surface)};
    for (int level = 0; level < levels; ++level) {
        RefinedSurface finer = split_edges(result.surface, std::vector<char>(result.surface.halfedge_count(), 1));
        result = {std::move(finer.surface), compose(result.map, finer.map)};
    }
    return result;
}

RefinedSurface subdivide_to(const Surface& surface, double max_edge) {
    if (!(max_edge > 0) || !std::isfinite(max_edge))
        throw Error(ErrorKind::bad_input, "max_edge must be a positive length");
    // A triangle ends as about area / (max_edge^2 / 4) vertices, two triangles a vertex.
    double predicted = 0;
    for (int f = 0; f < surface.face_count(); ++f) {
        double longest = 0;
        for (int k = 0; k < 3; ++k) longest = std::max(longest, surface.length(3 * f + k));
        const double halvings = std::max(0.0, std::ceil(std::log2(longest / max_edge)));
        predicted += std::max(
            0.5, std::min(std::pow(4.0, halvings) / 2, 4 * surface.face_area(f) / (max_edge * max_edge) + longest / max_edge));
    }
    if (predicted > vertex_limit)
        refuse(predicted);

    RefinedSurface result{surface, identity_map(surface)};
    while (true) {
        std::vector<char> marked(result.surface.halfedge_count(), 0);
        bool any = false;
        for (int h = 0; h < result.surface.halfedge_count(); ++h)
            if (result.surface.length(h) > max_edge) {
                marked[h] = 1;
                any = true;
            }
        if (!any)
            return result;
        RefinedSurface finer = split_edges(result.surface, marked);
        result = {std::move(finer.surface), compose(result.map, finer.map)};
        if (result.surface.vertex_count() > vertex_limit)
            refuse(result.surface.vertex_count());
    }
}

}  // namespace pvg
