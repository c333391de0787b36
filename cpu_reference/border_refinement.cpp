#include "cpu_reference/border_refinement.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace pvg {
namespace {

/// What a present border side is a piece of.
struct Piece {
    Side whole;
    double begin = 0, end = 1;
};

double square(double x) { return x * x; }

/// Distance of the corner's foot from the side's first vertex.
double foot(const LengthMesh& mesh, int half) {
    const auto& l = mesh.lengths[half / 3];
    const int k = half % 3;
    return (square(l[k]) + square(l[(k + 2) % 3]) - square(l[(k + 1) % 3])) / (2 * l[k]);
}

}  // namespace

std::vector<AddedVertex> refine_border(LengthMesh& mesh, const Border& border) {
    constexpr double slack = 1e-9;  // right angles with rounding stay
    const int given = static_cast<int>(border.held.size());
    std::vector<AddedVertex> added;
    std::map<Side, Piece> pieces;
    std::map<Side, Side> seams = border.seams;
    const auto side_of = [&](int half) {
        const auto& v = mesh.vertices[half / 3];
        return Side{v[half % 3], v[(half % 3 + 1) % 3]};
    };
    const auto border_sides = [&] {
        std::map<Side, int> found;
        std::vector<Side> crowded;  // where more than two triangles meet: left as they are
        for (int half = 0; half < static_cast<int>(3 * mesh.vertices.size()); ++half) {
            if (mesh.twins[half / 3][half % 3] < 0 && !found.emplace(side_of(half), half).second)
                crowded.push_back(side_of(half));
        }
        for (const Side& side : crowded) found.erase(side);
        return found;
    };
    std::map<Side, int> sides = border_sides();
    for (const auto& entry : sides) pieces[entry.first] = {entry.first, 0, 1};
    const std::size_t most = 1000 + 20 * pieces.size();

    // Side a-b gets vertex n at `distance` from a: triangle (a, b, c) becomes (a, n, c), and (n, b, c) is new.
    const auto split = [&](const Side& side, double distance) {
        const auto [a, b] = side;
        const int half = sides.at(side), f = half / 3, k = half % 3, g = static_cast<int>(mesh.vertices.size());
        const int n = given + static_cast<int>(added.size());
        const auto v = mesh.vertices[f];
        const auto l = mesh.lengths[f];
        const auto t = mesh.twins[f];
        const int k1 = (k + 1) % 3, k2 = (k + 2) % 3, c = v[k2];
        const double below = foot(mesh, half), height = std::sqrt(std::max(0.0, square(l[k2]) - square(below)));
        const double to_corner = std::hypot(distance - below, height);
        mesh.vertices[f] = {a, n, c};
        mesh.lengths[f] = {distance, to_corner, l[k2]};
        mesh.vertices.push_back({n, b, c});
        mesh.lengths.push_back({l[k] - distance, l[k1], to_corner});
        mesh.twins[f] = {-1, 3 * g + 2, t[k2]};
        mesh.twins.push_back({-1, t[k1], 3 * f + 1});
        const auto renamed = [&](int half_before) {
            return half_before == 3 * f + k1 ? 3 * g + 1 : half_before == 3 * f + k2 ? 3 * f + 2 : half_before;
        };
        for (int* twin : {&mesh.twins[f][2], &mesh.twins[g][1]}) {
            if (*twin >= 0)
                *twin = renamed(*twin);
        }
        for (int own : {3 * f + 2, 3 * g + 1}) {
            const int twin = mesh.twins[own / 3][own % 3];
            if (twin >= 0)
                mesh.twins[twin / 3][twin % 3] = own;
        }
        for (int i : {3 * f, 3 * f + 1, 3 * f + 2, 3 * g, 3 * g + 1, 3 * g + 2}) {
            if (mesh.twins[i / 3][i % 3] < 0)
                sides[side_of(i)] = i;
        }
        const Piece piece = pieces.at(side);
        const double at = piece.begin + distance / l[k] * (piece.end - piece.begin);
        pieces.erase(side);
        pieces[{a, n}] = {piece.whole, piece.begin, at};
        pieces[{n, b}] = {piece.whole, at, piece.end};
        added.push_back({piece.whole.first, piece.whole.second, at, -1});
        return n;
    };

    while (true) {
        flip_to_delaunay(mesh);
        sides = border_sides();
        std::vector<std::pair<Side, double>> splits;
        for (const auto& [side, half] : sides) {
            const Piece& piece = pieces.at(side);
            const auto seam = seams.find(side);
            const double cotangent = opposite_cotangent(mesh.lengths[half / 3], half % 3);
            if (seam == seams.end()) {
                const bool held = border.held[piece.whole.first] && border.held[piece.whole.second];
                if (!held && cotangent < -slack)
                    splits.emplace_back(side, foot(mesh, half));
                continue;
            }
            const int other = sides.at(seam->second);
            const double beyond = opposite_cotangent(mesh.lengths[other / 3], other % 3);
            // The bank with the larger angle names the place, for both.
            if (cotangent + beyond < -slack && (cotangent < beyond || (cotangent == beyond && side < seam->second)))
                splits.emplace_back(side, foot(mesh, half));
        }
        if (splits.empty())
            return added;
        if (added.size() + splits.size() > most)
            throw std::runtime_error("finite elements: points on the border do not come to an end");
        for (const auto& [side, distance] : splits) {
            const auto [a, b] = side;
            const auto seam = seams.find(side);
            if (seam == seams.end()) {
                split(side, distance);
                continue;
            }
            const Side other = seam->second;
            const int half = sides.at(other);
            const double length = mesh.lengths[half / 3][half % 3];
            const int n = split(side, distance), m = split(other, length - distance);
            added[n - given].across = m;
            added[m - given].across = n;
            seams.erase(side);
            seams.erase(other);
            for (const auto& [first, second] :
                 {std::pair{Side{a, n}, Side{m, other.second}}, std::pair{Side{n, b}, Side{other.first, m}}}) {
                seams[first] = second;
                seams[second] = first;
            }
        }
    }
}

}  // namespace pvg
