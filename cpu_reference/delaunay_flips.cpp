#include "cpu_reference/delaunay_flips.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <stdexcept>

namespace pvg {
namespace {

/// Area by W. Kahan's stable form of Heron's formula.
double triangle_area(std::array<double, 3> l) {
    std::sort(l.begin(), l.end(), std::greater<>());
    const double product = (l[0] + (l[1] + l[2])) * (l[2] - (l[0] - l[1])) * (l[2] + (l[0] - l[1])) * (l[0] + (l[1] - l[2]));
    return 0.25 * std::sqrt(std::max(0.0, product));
}

double square(double x) { return x * x; }

/// Apex of a triangle over the base (0, 0)-(base, 0): distances to its two ends.
Eigen::Vector2d apex(double base, double to_first, double to_second) {
    const double x = (square(to_first) + square(base) - square(to_second)) / (2 * base);
    return {x, std::sqrt(std::max(0.0, square(to_first) - x * x))};
}

bool is_delaunay(const LengthMesh& mesh, int half) {
    const int twin = mesh.twins[half / 3][half % 3];
    if (twin < 0 || twin / 3 == half / 3)
        return true;
    // A little slack, so that four cocircular points do not flip for ever.
    return opposite_cotangent(mesh.lengths[half / 3], half % 3) + opposite_cotangent(mesh.lengths[twin / 3], twin % 3) > -1e-9;
}

/// Replaces the side a-b of triangles (a, b, c), (b, a, d) by c-d. Returns the four sides around.
std::array<int, 4> flip(LengthMesh& mesh, int half) {
    const int f = half / 3, k = half % 3, twin = mesh.twins[f][k], g = twin / 3, m = twin % 3;
    const auto at = [](int i) { return i % 3; };
    const int a = mesh.vertices[f][k], b = mesh.vertices[f][at(k + 1)], c = mesh.vertices[f][at(k + 2)];
    const int d = mesh.vertices[g][at(m + 2)];
    const double ab = mesh.lengths[f][k], bc = mesh.lengths[f][at(k + 1)], ca = mesh.lengths[f][at(k + 2)];
    const double ad = mesh.lengths[g][at(m + 1)], db = mesh.lengths[g][at(m + 2)];
    const Eigen::Vector2d above = apex(ab, ca, bc), below = apex(ab, ad, db);
    const double cd = std::hypot(above.x() - below.x(), above.y() + below.y());

    const std::array<int, 4> before{3 * f + at(k + 1), 3 * f + at(k + 2), 3 * g + at(m + 1), 3 * g + at(m + 2)};  // bc ca ad db
    const std::array<int, 4> after{3 * f + 2, 3 * g + 1, 3 * g + 2, 3 * f + 1};
    std::array<int, 4> outer;
    for (int i = 0; i < 4; ++i) outer[i] = mesh.twins[before[i] / 3][before[i] % 3];

    mesh.vertices[f] = {c, d, b};
    mesh.lengths[f] = {cd, db, bc};
    mesh.vertices[g] = {d, c, a};
    mesh.lengths[g] = {cd, ca, ad};
    mesh.twins[f][0] = 3 * g;
    mesh.twins[g][0] = 3 * f;
    for (int i = 0; i < 4; ++i) {
        // The side may be glued to another of the four.
        const auto own = std::find(before.begin(), before.end(), outer[i]);
        const int target = own == before.end() ? outer[i] : after[own - before.begin()];
        mesh.twins[after[i] / 3][after[i] % 3] = target;
        if (target >= 0)
            mesh.twins[target / 3][target % 3] = after[i];
    }
    return after;
}

}  // namespace

LengthMesh make_length_mesh(const std::vector<Eigen::Vector3d>& points, const std::vector<std::array<int, 3>>& faces) {
    LengthMesh mesh;
    mesh.vertices = faces;
    mesh.lengths.resize(faces.size());
    mesh.twins.assign(faces.size(), {-1, -1, -1});
    std::map<std::pair<int, int>, std::vector<int>> directed;
    double total = 0;
    for (std::size_t f = 0; f < faces.size(); ++f) {
        for (int k = 0; k < 3; ++k) {
            const int i = faces[f][k], j = faces[f][(k + 1) % 3];
            mesh.lengths[f][k] = (points[i] - points[j]).norm();
            total += mesh.lengths[f][k];
            directed[{i, j}].push_back(static_cast<int>(3 * f) + k);
        }
    }
    for (const auto& [edge, halves] : directed) {
        const auto back = directed.find({edge.second, edge.first});
        if (halves.size() == 1 && back != directed.end() && back->second.size() == 1) {
            mesh.twins[halves[0] / 3][halves[0] % 3] = back->second[0];
        }
    }
    // Source of the common enlargement: N. Sharp, K. Crane, "A Laplacian for nonmanifold triangle meshes", 2020.
    const double room = faces.empty() ? 0 : 1e-9 * total / static_cast<double>(3 * faces.size());
    double enlarge = 0;
    for (const auto& l : mesh.lengths) {
        for (int k = 0; k < 3; ++k) enlarge = std::max(enlarge, room - (l[(k + 1) % 3] + l[(k + 2) % 3] - l[k]));
    }
    for (auto& l : mesh.lengths) {
        for (double& x : l) x += enlarge;
    }
    return mesh;
}

double opposite_cotangent(const std::array<double, 3>& l, int side) {
    const double p = square(l[(side + 1) % 3]) + square(l[(side + 2) % 3]) - square(l[side]);
    return p / (4 * triangle_area(l));
}

std::size_t flip_to_delaunay(LengthMesh& mesh) {
    std::deque<int> queue;
    for (int half = 0; half < static_cast<int>(3 * mesh.vertices.size()); ++half) queue.push_back(half);
    const std::size_t most = 1000 + 300 * mesh.vertices.size();
    std::size_t flips = 0;
    while (!queue.empty()) {
        const int half = queue.front();
        queue.pop_front();
        if (is_delaunay(mesh, half))
            continue;
        if (++flips > most)
            throw std::runtime_error("finite elements: edge flips do not come to an end");
        for (int side : flip(mesh, half)) queue.push_back(side);
    }
    return flips;
}

}  // namespace pvg
