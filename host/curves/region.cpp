#include "curves/region.h"

#include <cmath>
#include <cstdio>
#include <string>

#include "pvg/status.h"

namespace pvg {
namespace {

std::string in_words(const Point& p) {
    char text[96];
    std::snprintf(text, sizeof text, "[%.6g, %.6g, %.6g]", p[0], p[1], p[2]);
    return text;
}

}  // namespace

std::vector<ChainEdge> chain_edges(const Surface& surface, const CurveChain& chain) {
    std::vector<ChainEdge> edges;
    const std::size_t count = chain.vertices.size();
    if (count < 2)
        return edges;
    for (std::size_t i = 0; i + (chain.closed ? 0 : 1) < count; ++i) {
        const int from = chain.vertices[i], to = chain.vertices[(i + 1) % count];
        const ChainEdge edge{surface.halfedge_between(from, to), surface.halfedge_between(to, from)};
        if (edge.left == none && edge.right == none)
            throw Error(ErrorKind::bad_input, "the curve is not a chain of mesh edges at " + in_words(surface.point(from)));
        edges.push_back(edge);
    }
    return edges;
}

CurveChain without_spikes(CurveChain chain) {
    CurveChain result;
    result.closed = chain.closed;
    for (std::size_t i = 0; i < chain.vertices.size(); ++i) {
        const std::size_t size = result.vertices.size();
        if (size >= 2 && result.vertices[size - 2] == chain.vertices[i]) {
            result.vertices.pop_back();
            result.t.pop_back();
        } else if (size == 0 || result.vertices.back() != chain.vertices[i]) {
            result.vertices.push_back(chain.vertices[i]);
            result.t.push_back(chain.t[i]);
        }
    }
    // The same across the seam of a closed chain; the first vertex keeps its place unless it is the spike.
    while (result.closed && result.vertices.size() > 3) {
        const std::size_t size = result.vertices.size();
        if (result.vertices[size - 1] == result.vertices[0] || result.vertices[size - 1] == result.vertices[1]) {
            if (result.vertices[size - 1] == result.vertices[1]) {
                result.vertices[0] = result.vertices[1];
                result.vertices.erase(result.vertices.begin() + 1);
                result.t.erase(result.t.begin() + 1);
            }
            result.vertices.pop_back();
            result.t.pop_back();
        } else if (result.vertices[size - 2] == result.vertices[0]) {
            result.vertices.resize(size - 2);
            result.t.resize(size - 2);
        } else {
            break;
        }
    }
    return result;
}

void mark_chain(const Surface& surface, const CurveChain& chain, std::vector<char>& flags) {
    for (const ChainEdge& edge : chain_edges(surface, chain)) {
        if (edge.left != none)
            flags[edge.left] = 1;
        if (edge.right != none)
            flags[edge.right] = 1;
    }
}

std::vector<char> flood_faces(const Surface& surface, std::span<const char> barrier, std::span<const int> seeds) {
    std::vector<char> reached(surface.face_count(), 0);
    std::vector<int> stack;
    for (int seed : seeds)
        if (!reached[seed]) {
            reached[seed] = 1;
            stack.push_back(seed);
        }
    while (!stack.empty()) {
        const int f = stack.back();
        stack.pop_back();
        for (int h = 3 * f; h < 3 * f + 3; ++h) {
            const int twin = surface.twin(h);
            if (twin == none || barrier[h] || barrier[twin] || reached[twin / 3])
                continue;
            reached[twin / 3] = 1;
            stack.push_back(twin / 3);
        }
    }
    return reached;
}

std::vector<char> faces_inside(const Surface& surface, const CurveChain& chain) {
    std::vector<char> seen(surface.vertex_count(), 0);
    for (int v : chain.vertices) {
        if (seen[v])
            throw Error(ErrorKind::bad_input, "the closed path meets itself at " + in_words(surface.point(v)) +
                                                  "; expected a path that does not cross itself");
        seen[v] = 1;
    }
    std::vector<char> barrier(surface.halfedge_count(), 0);
    mark_chain(surface, chain, barrier);
    std::vector<int> left_seeds, right_seeds;
    for (const ChainEdge& edge : chain_edges(surface, chain)) {
        if (edge.left != none)
            left_seeds.push_back(edge.left / 3);
        if (edge.right != none)
            right_seeds.push_back(edge.right / 3);
    }
    std::vector<char> left = flood_faces(surface, barrier, left_seeds);
    std::vector<char> right = flood_faces(surface, barrier, right_seeds);
    double left_area = 0, right_area = 0;
    for (int f = 0; f < surface.face_count(); ++f) {
        if (left[f] && right[f])
            throw Error(ErrorKind::bad_input, "the closed path does not separate the surface: both of its sides near " +
                                                  in_words(surface.point(chain.vertices.front())) +
                                                  " are one part; expected a path that bounds a region");
        if (left[f])
            left_area += surface.face_area(f);
        if (right[f])
            right_area += surface.face_area(f);
    }
    if (right_seeds.empty())
        return left;
    if (left_seeds.empty())
        return right;
    return left_area <= right_area + 1e-9 * (left_area + right_area) ? left : right;
}

}  // namespace pvg
