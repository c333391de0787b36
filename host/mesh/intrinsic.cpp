// Edge flips after Bobenko and Springborn, "A discrete Laplace-Beltrami operator for simplicial surfaces" (2007): any order of
// flips ends at the intrinsic Delaunay triangulation. Areas from lengths after Kahan, "Miscalculating area and angles of a
// needle-like triangle" (2014).
#include "mesh/intrinsic.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

namespace pvg {
namespace {

int next(int halfedge) { return Surface::next(halfedge); }
int prev(int halfedge) { return Surface::prev(halfedge); }

/// sin(alpha + beta) >= 0, without a division, so that triangles without area take part.
bool is_delaunay(const IntrinsicTriangulation& triangulation, int halfedge, int twin) {
    // Far above the rounding of the four products, far below any weight that matters; without it cocircular quads could flip for
    // ever.
    constexpr double tolerance = 1e-13;
    const OppositeAngle a = opposite_angle(triangulation, halfedge), b = opposite_angle(triangulation, twin);
    return a.sine * b.cosine + a.cosine * b.sine >= -tolerance * a.scale * b.scale;
}

/// Third corner of a face over its halfedge laid from (0, 0) along +x.
Eigen::Vector2d apex(const IntrinsicTriangulation& triangulation, int halfedge) {
    const auto& length = triangulation.lengths[halfedge / 3];
    const double side = length[halfedge % 3], far = length[next(halfedge) % 3], near = length[prev(halfedge) % 3];
    return {0.5 * (side + (near - far) * (near + far) / side), 2 * triangle_area(length) / side};
}

void join(IntrinsicTriangulation& triangulation, int a, int b) {
    triangulation.twin[a] = b;
    if (b != none)
        triangulation.twin[b] = a;
}

/// Quad i, m, j, k around the edge i - j becomes the triangles (m, j, k) and (k, i, m).
void flip(IntrinsicTriangulation& triangulation, int h, int t) {
    const int f = h / 3, g = t / 3;
    const Eigen::Vector2d above = apex(triangulation, h), below = apex(triangulation, t);
    const double side = triangulation.lengths[f][h % 3];
    const double diagonal = std::hypot(above.x() - (side - below.x()), above.y() + below.y());

    const int jk = next(h), ki = prev(h), im = next(t), mj = prev(t);
    const auto vertex = [&](int halfedge) { return triangulation.faces[halfedge / 3][halfedge % 3]; };
    const auto length = [&](int halfedge) { return triangulation.lengths[halfedge / 3][halfedge % 3]; };
    const int i = vertex(h), j = vertex(t), k = vertex(ki), m = vertex(mj);
    const std::array<double, 3> first{length(mj), length(jk), diagonal}, second{length(ki), length(im), diagonal};
    // Outer edges may be glued to each other, so their twins are renamed together.
    const std::array<int, 4> old_side{mj, jk, ki, im}, new_side{3 * f, 3 * f + 1, 3 * g, 3 * g + 1};
    std::array<int, 4> outer;
    for (int s = 0; s < 4; ++s) {
        outer[s] = triangulation.twin[old_side[s]];
        for (int r = 0; r < 4; ++r)
            if (outer[s] == old_side[r]) {
                outer[s] = new_side[r];
                break;
            }
    }
    triangulation.faces[f] = {m, j, k};
    triangulation.faces[g] = {k, i, m};
    triangulation.lengths[f] = first;
    triangulation.lengths[g] = second;
    for (int s = 0; s < 4; ++s) join(triangulation, new_side[s], outer[s]);
    join(triangulation, 3 * f + 2, 3 * g + 2);
}

}  // namespace

double triangle_area(const std::array<double, 3>& lengths) {
    auto [a, b, c] = lengths;
    if (a < b)
        std::swap(a, b);
    if (a < c)
        std::swap(a, c);
    if (b < c)
        std::swap(b, c);
    const double square = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c));
    return square > 0 ? 0.25 * std::sqrt(square) : 0;
}

OppositeAngle opposite_angle(const IntrinsicTriangulation& triangulation, int halfedge) {
    const auto& length = triangulation.lengths[halfedge / 3];
    const double side = length[halfedge % 3], p = length[next(halfedge) % 3], q = length[prev(halfedge) % 3];
    // p^2 - l^2 as a product: no cancellation of squares in a needle.
    return {2 * triangle_area(length), 0.5 * ((p - side) * (p + side) + q * q), p * q};
}

IntrinsicTriangulation intrinsic_triangulation(const Surface& surface) {
    IntrinsicTriangulation result;
    result.faces = surface.faces();
    result.lengths.resize(surface.face_count());
    result.twin.resize(surface.halfedge_count());
    for (int h = 0; h < surface.halfedge_count(); ++h) {
        const int t = surface.twin(h);
        result.twin[h] = t;
        // One computation an edge: both faces hold the same bits.
        result.lengths[h / 3][h % 3] = surface.length(t == none ? h : std::min(h, t));
    }
    return result;
}

int make_delaunay(IntrinsicTriangulation& triangulation) {
    std::vector<int> all(triangulation.twin.size());
    std::iota(all.begin(), all.end(), 0);
    return make_delaunay(triangulation, all);
}

int make_delaunay(IntrinsicTriangulation& triangulation, std::span<const int> seeds) {
    const int halfedges = static_cast<int>(triangulation.twin.size());
    std::vector<int> queue;
    std::vector<char> queued(halfedges, 0);
    const auto push = [&](int h) {
        const int t = triangulation.twin[h];
        if (t == none || queued[h] || queued[t])
            return;
        queued[h] = 1;
        queue.push_back(h);
    };
    for (std::size_t i = seeds.size(); i-- > 0;)
        if (const int h = seeds[i], t = triangulation.twin[h]; t != none)
            push(std::min(h, t));

    // Flips end by theory (the Dirichlet energy falls with each); the cap only guards against rounding.
    const long long cap = 100LL * halfedges + 1000;
    int flips = 0;
    while (!queue.empty() && flips < cap) {
        const int h = queue.back();
        queue.pop_back();
        queued[h] = 0;
        const int t = triangulation.twin[h];
        // A face glued to itself cannot be flipped and never has to be: the two opposite angles are its equal acute ones.
        if (t == none || h / 3 == t / 3 || triangulation.lengths[h / 3][h % 3] <= 0)
            continue;
        if (is_delaunay(triangulation, h, t))
            continue;
        const int f = h / 3, g = t / 3;
        flip(triangulation, h, t);
        ++flips;
        for (int outer : {3 * f, 3 * f + 1, 3 * g, 3 * g + 1}) push(outer);
    }
    return flips;
}

Eigen::SparseMatrix<double> cotan_stiffness(const IntrinsicTriangulation& triangulation, int vertex_count) {
    // Weights of a face whose area rounds to zero stay finite: a cap's vertex is then tied to the line it lies on, as in the
    // limit.
    constexpr double smallest_sine = 1e-10;
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(4 * triangulation.twin.size());
    for (int h = 0; h < static_cast<int>(triangulation.twin.size()); ++h) {
        const int i = triangulation.faces[h / 3][h % 3], j = triangulation.faces[h / 3][next(h) % 3];
        if (i == j)
            continue;
        const auto& length = triangulation.lengths[h / 3];
        const double longest = std::max({length[0], length[1], length[2]});
        if (longest <= 0)
            continue;
        const OppositeAngle angle = opposite_angle(triangulation, h);
        const double weight = 0.5 * angle.cosine / std::max(angle.sine, smallest_sine * longest * longest);
        entries.emplace_back(i, j, -weight);
        entries.emplace_back(j, i, -weight);
        entries.emplace_back(i, i, weight);
        entries.emplace_back(j, j, weight);
    }
    Eigen::SparseMatrix<double> stiffness(vertex_count, vertex_count);
    stiffness.setFromTriplets(entries.begin(), entries.end());
    return stiffness;
}

Eigen::VectorXd lumped_areas(const IntrinsicTriangulation& triangulation, int vertex_count) {
    Eigen::VectorXd areas = Eigen::VectorXd::Zero(vertex_count);
    for (std::size_t f = 0; f < triangulation.faces.size(); ++f) {
        const auto& length = triangulation.lengths[f];
        const double third = triangle_area(length) / 3;
        for (int v : triangulation.faces[f]) areas[v] += third;
    }
    return areas;
}

}  // namespace pvg
