#include "mesh/surface.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "pvg/status.h"

namespace pvg {
namespace {

[[noreturn]] void refuse(const std::string& what) { throw Error(ErrorKind::bad_input, "surface: " + what); }

double angle_between(const Point& a, const Point& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

}  // namespace

Surface::Surface(std::vector<Point> points, std::vector<Face> faces) : points_(std::move(points)), faces_(std::move(faces)) {
    const int vertices = vertex_count();
    for (int f = 0; f < face_count(); ++f) {
        const Face& face = faces_[f];
        for (int v : face)
            if (v < 0 || v >= vertices)
                refuse("face " + std::to_string(f) + ": vertex " + std::to_string(v) + " is not below " +
                       std::to_string(vertices));
        if (face[0] == face[1] || face[1] == face[2] || face[2] == face[0])
            refuse("face " + std::to_string(f) + " repeats a vertex");
    }

    // Halfedges sorted by origin, then target; the twin of a -> b is found among those that leave b.
    std::vector<int> first(vertices + 1, 0), leaving(halfedge_count());
    for (int h = 0; h < halfedge_count(); ++h) ++first[origin(h) + 1];
    for (int v = 0; v < vertices; ++v) first[v + 1] += first[v];
    {
        std::vector<int> fill(first.begin(), first.end() - 1);
        for (int h = 0; h < halfedge_count(); ++h) leaving[fill[origin(h)]++] = h;
        for (int v = 0; v < vertices; ++v)
            std::sort(leaving.begin() + first[v], leaving.begin() + first[v + 1],
                      [&](int g, int h) { return target(g) != target(h) ? target(g) < target(h) : g < h; });
    }
    const auto between = [&](int from, int to) {
        const auto end = leaving.begin() + first[from + 1];
        const auto at = std::lower_bound(leaving.begin() + first[from], end, to, [&](int h, int v) { return target(h) < v; });
        return at != end && target(*at) == to ? *at : none;
    };
    twin_.assign(halfedge_count(), none);
    for (int h = 0; h < halfedge_count(); ++h) {
        if (between(origin(h), target(h)) != h)
            refuse("edge " + std::to_string(origin(h)) + " - " + std::to_string(target(h)) +
                   " has two faces of the same orientation");
        if (twin_[h] != none)
            continue;
        twin_[h] = between(target(h), origin(h));
        if (twin_[h] != none)
            twin_[twin_[h]] = h;
    }

    outgoing_.assign(vertices, none);
    std::vector<int> valence(vertices, 0);
    for (int h = 0; h < halfedge_count(); ++h) {
        ++valence[origin(h)];
        int& chosen = outgoing_[origin(h)];
        if (chosen == none || (twin_[h] == none && twin_[chosen] != none))
            chosen = h;
    }
    for (int v = 0; v < vertices; ++v) {
        if (outgoing_[v] == none)
            continue;
        int seen = 0;
        int h = outgoing_[v];
        do {
            ++seen;
            h = twin_[prev(h)];
        } while (h != none && h != outgoing_[v] && seen <= valence[v]);
        if (seen != valence[v])
            refuse("the faces around vertex " + std::to_string(v) + " are not one fan");
    }
}

double Surface::face_area(int face) const {
    const auto& [a, b, c] = faces_[face];
    return 0.5 * (points_[b] - points_[a]).cross(points_[c] - points_[a]).norm();
}

double Surface::area() const {
    double sum = 0;
    for (int f = 0; f < face_count(); ++f) sum += face_area(f);
    return sum;
}

Point Surface::face_normal(int face) const {
    const auto& [a, b, c] = faces_[face];
    const Point n = (points_[b] - points_[a]).cross(points_[c] - points_[a]);
    const double size = n.norm();
    return size > 0 ? Point(n / size) : Point::Zero();
}

double Surface::angle_sum(int vertex) const {
    double sum = 0;
    int h = outgoing_[vertex];
    if (h == none)
        return 0;
    const int first = h;
    do {
        sum += angle_between(points_[target(h)] - points_[vertex], points_[origin(prev(h))] - points_[vertex]);
        h = twin_[prev(h)];
    } while (h != none && h != first);
    return sum;
}

Point Surface::position(const SurfacePoint& at) const {
    const auto& [a, b, c] = faces_[at.face];
    // A vertex must come back bit for bit.
    for (int k = 0; k < 3; ++k)
        if (at.bary[k] == 1.0)
            return points_[faces_[at.face][k]];
    return at.bary[0] * points_[a] + at.bary[1] * points_[b] + at.bary[2] * points_[c];
}

double Surface::diagonal() const {
    if (faces_.empty())
        return 0;
    Point low = points_[faces_[0][0]], high = low;
    for (const Face& face : faces_)
        for (int v : face) {
            low = low.cwiseMin(points_[v]);
            high = high.cwiseMax(points_[v]);
        }
    return (high - low).norm();
}

int Surface::halfedge_between(int from, int to) const {
    int h = outgoing_[from];
    if (h == none)
        return none;
    const int first = h;
    do {
        if (target(h) == to)
            return h;
        h = twin_[prev(h)];
    } while (h != none && h != first);
    return none;  // on a border the last edge of the fan exists only as to -> from
}

std::vector<int> face_components(const Surface& surface, int* count) {
    std::vector<int> component(surface.face_count(), none);
    std::vector<int> stack;
    int found = 0;
    for (int seed = 0; seed < surface.face_count(); ++seed) {
        if (component[seed] != none)
            continue;
        component[seed] = found;
        stack.assign(1, seed);
        while (!stack.empty()) {
            const int f = stack.back();
            stack.pop_back();
            for (int k = 0; k < 3; ++k) {
                const int other = surface.twin(3 * f + k);
                if (other == none || component[other / 3] != none)
                    continue;
                component[other / 3] = found;
                stack.push_back(other / 3);
            }
        }
        ++found;
    }
    if (count)
        *count = found;
    return component;
}

std::vector<Point> vertex_normals(const Surface& surface) {
    std::vector<Point> normals(surface.vertex_count(), Point::Zero());
    for (int h = 0; h < surface.halfedge_count(); ++h) {
        const Point& at = surface.point(surface.origin(h));
        const Point along = surface.point(surface.target(h)) - at;
        const Point back = surface.point(surface.origin(Surface::prev(h))) - at;
        normals[surface.origin(h)] += angle_between(along, back) * surface.face_normal(h / 3);
    }
    for (Point& n : normals) {
        const double size = n.norm();
        if (size > 0)
            n /= size;
    }
    return normals;
}

}  // namespace pvg
