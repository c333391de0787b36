#include "mesh/weld.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <unordered_map>

namespace pvg {
namespace {

struct PositionKey {
    std::array<std::uint64_t, 3> bits;
    bool operator==(const PositionKey&) const = default;
};

struct PositionHash {
    std::size_t operator()(const PositionKey& key) const {
        std::uint64_t h = 0x9e3779b97f4a7c15ull;
        for (std::uint64_t word : key.bits) {
            h ^= word;
            h *= 0xff51afd7ed558ccdull;
            h ^= h >> 32;
        }
        return static_cast<std::size_t>(h);
    }
};

PositionKey key_of(const Point& p) {
    PositionKey key;
    for (int i = 0; i < 3; ++i) key.bits[i] = std::bit_cast<std::uint64_t>(p[i] == 0 ? 0.0 : p[i]);
    return key;
}

/// Twins of halfedges where exactly two oppositely oriented faces meet; everything else is cut.
std::vector<int> manifold_twins(const std::vector<Face>& faces, const std::vector<Point>& points,
                                std::vector<std::array<Point, 2>>& cut) {
    const int halfedges = static_cast<int>(3 * faces.size());
    const auto from = [&](int h) { return faces[h / 3][h % 3]; };
    const auto to = [&](int h) { return faces[h / 3][(h + 1) % 3]; };
    // Halfedges sorted by their edge: first by its lower vertex (in linear time), then by the higher one.
    std::vector<int> first(points.size() + 1, 0), sorted(halfedges);
    for (int h = 0; h < halfedges; ++h) ++first[std::min(from(h), to(h)) + 1];
    for (std::size_t v = 0; v < points.size(); ++v) first[v + 1] += first[v];
    {
        std::vector<int> fill(first.begin(), first.end() - 1);
        for (int h = 0; h < halfedges; ++h) sorted[fill[std::min(from(h), to(h))]++] = h;
    }
    std::vector<int> twin(halfedges, none), cut_at;
    for (std::size_t v = 0; v < points.size(); ++v) {
        const auto begin = sorted.begin() + first[v], end = sorted.begin() + first[v + 1];
        const auto high = [&](int h) { return std::max(from(h), to(h)); };
        std::sort(begin, end, [&](int g, int h) { return high(g) != high(h) ? high(g) < high(h) : g < h; });
        for (auto edge = begin; edge != end;) {
            auto next = edge + 1;
            while (next != end && high(*next) == high(*edge)) ++next;
            if (next - edge == 2 && from(edge[0]) == to(edge[1])) {
                twin[edge[0]] = edge[1];
                twin[edge[1]] = edge[0];
            } else if (next - edge > 1) {
                cut_at.push_back(*edge);
            }
            edge = next;
        }
    }
    std::sort(cut_at.begin(), cut_at.end());
    for (int h : cut_at) cut.push_back({points[from(h)], points[to(h)]});
    return twin;
}

}  // namespace

WeldedMesh weld(std::span<const Point> points, std::span<const Face> faces, Warnings& warnings) {
    WeldedMesh result;
    std::unordered_map<PositionKey, int, PositionHash> by_position;
    by_position.reserve(points.size());
    std::vector<int> welded(points.size(), none);
    std::vector<Point> shared;
    // Only vertices that a face uses count, in the order of first use, so that the result does not depend on unreferenced ones.
    std::vector<Face> kept;
    result.raw_to_welded.assign(faces.size(), Face{none, none, none});
    std::size_t left_out = 0;
    for (std::size_t f = 0; f < faces.size(); ++f) {
        Face face;
        for (int k = 0; k < 3; ++k) {
            const int raw = faces[f][k];
            if (welded[raw] == none) {
                const auto [at, fresh] = by_position.emplace(key_of(points[raw]), static_cast<int>(shared.size()));
                if (fresh)
                    shared.push_back(points[raw]);
                welded[raw] = at->second;
            }
            face[k] = welded[raw];
        }
        const bool repeated = face[0] == face[1] || face[1] == face[2] || face[2] == face[0];
        const Point normal = (shared[face[1]] - shared[face[0]]).cross(shared[face[2]] - shared[face[0]]);
        if (repeated || !(normal.norm() > 0)) {
            ++left_out;
            continue;
        }
        kept.push_back(face);
        result.face_raw.push_back(static_cast<int>(f));
    }
    if (left_out > 0)
        warnings.push_back(std::to_string(left_out) + (left_out == 1 ? " triangle has" : " triangles have") +
                           " no area; left as found and not decorated");

    const std::vector<int> twin = manifold_twins(kept, shared, result.non_manifold_edges);

    // One vertex per fan: walk each fan from its first face, and give later fans of a position copies of it.
    std::vector<int> corner_vertex(3 * kept.size(), none);
    std::vector<char> used(shared.size(), 0);
    std::size_t pinched = 0;
    const std::size_t positions = shared.size();
    for (int h = 0; h < static_cast<int>(corner_vertex.size()); ++h) {
        if (corner_vertex[h] != none)
            continue;
        const int position = kept[h / 3][h % 3];
        int vertex = position;
        if (used[position]) {
            vertex = static_cast<int>(shared.size());
            shared.push_back(shared[position]);
            ++pinched;
        }
        used[position] = 1;
        // Back (clockwise) to the border if there is one, then forward through the fan.
        int first = h;
        while (twin[first] != none) {
            const int before = Surface::next(twin[first]);
            if (before == h)
                break;
            first = before;
        }
        for (int at = first; at != none && corner_vertex[at] == none; at = twin[Surface::prev(at)]) corner_vertex[at] = vertex;
    }
    for (std::size_t f = 0; f < kept.size(); ++f)
        for (int k = 0; k < 3; ++k) {
            kept[f][k] = corner_vertex[3 * f + k];
            result.raw_to_welded[result.face_raw[f]][k] = kept[f][k];
        }
    if (!result.non_manifold_edges.empty() || pinched > 0)
        warnings.push_back("the surface is not manifold: cut at " + std::to_string(result.non_manifold_edges.size()) +
                           " edges and apart into " + std::to_string(shared.size()) + " vertices at " +
                           std::to_string(positions) + " positions");
    result.surface = Surface(std::move(shared), std::move(kept));
    return result;
}

}  // namespace pvg
