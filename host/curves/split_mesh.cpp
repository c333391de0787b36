#include "curves/split_mesh.h"

#include <algorithm>
#include <limits>

namespace pvg {
namespace {

// A flip must leave two triangles well above rounding: twice the area over the new edge's squared length, in barycentric
// coordinates.
constexpr double thinnest = 1e-9;

std::uint64_t edge_key(int a, int b) {
    return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(std::min(a, b))) << 32) |
           static_cast<std::uint32_t>(std::max(a, b));
}

}  // namespace

double orientation(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
    for (int k = 0; k < 3; ++k)
        if (a[k] == 0 && b[k] == 0 && c[k] == 0)
            return 0;
    const Eigen::Vector3d u = b - a, v = c - a;
    return u[0] * v[1] - u[1] * v[0];
}

SplitMesh::SplitMesh(const Surface& parent) : parent_(parent), points_(parent.points()), faces_(parent.faces()) {
    SurfaceMap map = identity_map(parent);
    origins_ = std::move(map.vertex);
    face_parent_ = std::move(map.face);
    twin_.resize(parent.halfedge_count());
    for (int h = 0; h < parent.halfedge_count(); ++h) twin_[h] = parent.twin(h);
    fixed_.assign(twin_.size(), 0);
    outgoing_.resize(parent.vertex_count());
    for (int v = 0; v < parent.vertex_count(); ++v) outgoing_[v] = parent.outgoing(v);
    shortest_.assign(parent.vertex_count(), 0);
}

void SplitMesh::fix(int halfedge) {
    fixed_[halfedge] = 1;
    if (twin_[halfedge] != none)
        fixed_[twin_[halfedge]] = 1;
    shorten(halfedge);
}

void SplitMesh::shorten(int halfedge) {
    const double length = (points_[to(halfedge)] - points_[from(halfedge)]).norm();
    for (int v : {from(halfedge), to(halfedge)})
        if (shortest_[v] > 0)
            shortest_[v] = std::min(shortest_[v], length);
}

int SplitMesh::edge_between(int a, int b) const {
    const int first = outgoing_[a];
    int h = first;
    while (h != none) {
        if (to(h) == b)
            return h;
        const int back = Surface::prev(h);
        if (from(back) == b)
            return twin_[back] == none ? back : twin_[back];
        h = twin_[back];
        if (h == first)
            break;
    }
    return none;
}

std::vector<int> SplitMesh::fan(int vertex, int parent_face) const {
    std::vector<int> inside;
    const int first = outgoing_[vertex];
    int h = first;
    int breaks_at = 0;  // where the part of the fan that lies in the parent face begins, when the walk starts inside that part
    int last = none;
    while (h != none) {
        if (this->parent_face(h) == parent_face) {
            if (!inside.empty() && last != parent_face)
                breaks_at = static_cast<int>(inside.size());
            inside.push_back(h);
        }
        last = this->parent_face(h);
        h = twin_[Surface::prev(h)];
        if (h == first)
            break;
    }
    std::rotate(inside.begin(), inside.begin() + breaks_at, inside.end());
    return inside;
}

double SplitMesh::shortest_edge(int vertex) {
    double& shortest = shortest_[vertex];
    if (shortest > 0)
        return shortest;
    shortest = std::numeric_limits<double>::infinity();
    const int first = outgoing_[vertex];
    int h = first;
    while (h != none) {
        const int back = Surface::prev(h);
        if (stays(h))
            shortest = std::min(shortest, (points_[to(h)] - points_[vertex]).norm());
        if (stays(back))
            shortest = std::min(shortest, (points_[from(back)] - points_[vertex]).norm());
        h = twin_[back];
        if (h == first)
            break;
    }
    return shortest;
}

bool SplitMesh::contains(int parent_face, int vertex) const {
    const Face& corners = parent_.face(parent_face);
    const VertexOrigin& origin = origins_[vertex];
    for (int i = 0; i < 3 && origin.vertex[i] != none; ++i)
        if (std::find(corners.begin(), corners.end(), origin.vertex[i]) == corners.end())
            return false;
    return true;
}

Eigen::Vector3d SplitMesh::bary(int parent_face, int vertex) const {
    const Face& corners = parent_.face(parent_face);
    const VertexOrigin& origin = origins_[vertex];
    Eigen::Vector3d at(0, 0, 0);
    for (int i = 0; i < 3 && origin.vertex[i] != none; ++i)
        for (int k = 0; k < 3; ++k)
            if (corners[k] == origin.vertex[i])
                at[k] = origin.weight[i];
    return at;
}

int SplitMesh::add_vertex(int parent_face, const Eigen::Vector3d& bary) {
    const Face& corners = parent_.face(parent_face);
    VertexOrigin origin{{none, none, none}, {0, 0, 0}};
    const double sum = bary.sum();
    int used = 0;
    for (int k = 0; k < 3; ++k) {
        if (bary[k] == 0)
            continue;
        origin.vertex[used] = corners[k];
        origin.weight[used++] = bary[k] / sum;
    }
    Point at = Point::Zero();
    for (int i = 0; i < used; ++i) at += origin.weight[i] * parent_.point(origin.vertex[i]);
    points_.push_back(at);
    origins_.push_back(origin);
    outgoing_.push_back(none);
    shortest_.push_back(0);
    return vertex_count() - 1;
}

int SplitMesh::add_face(int parent_face) {
    faces_.push_back({none, none, none});
    face_parent_.push_back(parent_face);
    twin_.insert(twin_.end(), 3, none);
    fixed_.insert(fixed_.end(), 3, 0);
    return face_count() - 1;
}

void SplitMesh::link(int h, int t) {
    twin_[h] = t;
    if (t != none)
        twin_[t] = h;
}

// Keeps outgoing_ a halfedge of its vertex, and the border one where there is one.
void SplitMesh::claim(int h) {
    const int v = from(h);
    const int held = outgoing_[v];
    if (held == none || from(held) != v || (twin_[h] == none && twin_[held] != none))
        outgoing_[v] = h;
}

void SplitMesh::renew(int face) {
    for (int h = 3 * face; h < 3 * face + 3; ++h) {
        claim(h);
        if (stays(h))
            shorten(h);
    }
    renewed_.push_back(face);
}

int SplitMesh::split_face(int face, const Eigen::Vector3d& bary) {
    const int n = add_vertex(face_parent_[face], bary);
    const auto [a, b, c] = faces_[face];
    const std::array<int, 3> outside{twin_[3 * face], twin_[3 * face + 1], twin_[3 * face + 2]};
    const std::array<char, 3> held{fixed_[3 * face], fixed_[3 * face + 1], fixed_[3 * face + 2]};
    const std::array<int, 3> parts{face, add_face(face_parent_[face]), add_face(face_parent_[face])};
    faces_[parts[0]] = {a, b, n};
    faces_[parts[1]] = {b, c, n};
    faces_[parts[2]] = {c, a, n};
    for (int k = 0; k < 3; ++k) {
        link(3 * parts[k], outside[k]);
        link(3 * parts[k] + 1, 3 * parts[(k + 1) % 3] + 2);
        fixed_[3 * parts[k]] = held[k];
        fixed_[3 * parts[k] + 1] = fixed_[3 * parts[k] + 2] = 0;
    }
    for (int part : parts) renew(part);
    return n;
}

int SplitMesh::split_edge(int halfedge, const Eigen::Vector3d& bary) {
    const int n = add_vertex(parent_face(halfedge), bary);
    const int u = from(halfedge), w = to(halfedge);
    const bool held = fixed_[halfedge];
    if (held)
        split_.emplace(edge_key(u, w), n);

    // Each side (x -> y, apex z) becomes (x, n, z), in place, and (n, y, z), new.
    std::array<int, 2> side{halfedge, twin_[halfedge]};
    std::array<int, 2> fresh{none, none};
    for (int i = 0; i < 2; ++i) {
        if (side[i] == none)
            continue;
        const int face = side[i] / 3;
        const int ahead = Surface::next(side[i]);
        const int y = to(side[i]), z = apex(side[i]);
        fresh[i] = add_face(face_parent_[face]);
        faces_[fresh[i]] = {n, y, z};
        link(3 * fresh[i] + 1, twin_[ahead]);
        fixed_[3 * fresh[i] + 1] = fixed_[ahead];
        faces_[face][ahead % 3] = n;
        link(ahead, 3 * fresh[i] + 2);
        fixed_[ahead] = fixed_[3 * fresh[i] + 2] = 0;
        fixed_[3 * fresh[i]] = held;
    }
    if (side[1] != none) {
        link(side[0], 3 * fresh[1]);
        link(side[1], 3 * fresh[0]);
    }
    for (int i = 0; i < 2; ++i)
        if (side[i] != none) {
            renew(side[i] / 3);
            renew(fresh[i]);
        }
    return n;
}

bool SplitMesh::flip(int halfedge) {
    if (fixed_[halfedge] || !inside_parent(halfedge))
        return false;
    const int t = twin_[halfedge];
    const int u = from(halfedge), w = to(halfedge), o = apex(halfedge), p = apex(t);
    const int parent = parent_face(halfedge);
    const Eigen::Vector3d at_o = bary(parent, o), at_p = bary(parent, p);
    const double least = thinnest * (at_o - at_p).squaredNorm();
    if (!(orientation(at_p, at_o, bary(parent, u)) > least) || !(orientation(at_o, at_p, bary(parent, w)) > least))
        return false;

    const int f = halfedge / 3, g = t / 3;
    const std::array<int, 4> rim{Surface::next(halfedge), Surface::prev(halfedge), Surface::next(t),
                                 Surface::prev(t)};  // w-o, o-u, u-p, p-w
    std::array<int, 4> outside;
    std::array<char, 4> held;
    for (int k = 0; k < 4; ++k) {
        outside[k] = twin_[rim[k]];
        held[k] = fixed_[rim[k]];
    }
    faces_[f] = {p, o, u};  // p-o, o-u, u-p
    faces_[g] = {o, p, w};  // o-p, p-w, w-o
    link(3 * f, 3 * g);
    fixed_[3 * f] = fixed_[3 * g] = 0;
    const std::array<int, 4> place{3 * g + 2, 3 * f + 1, 3 * f + 2, 3 * g + 1};
    for (int k = 0; k < 4; ++k) {
        // A rim edge may join two of the quadrilateral's own sides only in a closed two-face piece, which never lies in one
        // parent face.
        link(place[k], outside[k]);
        fixed_[place[k]] = held[k];
    }
    renew(f);
    renew(g);
    return true;
}

void SplitMesh::make_delaunay() {
    while (!renewed_.empty()) {
        const int face = renewed_.back();
        renewed_.pop_back();
        for (int h = 3 * face; h < 3 * face + 3; ++h) {
            if (fixed_[h] || !inside_parent(h))
                continue;
            const Point &u = points_[from(h)], &w = points_[to(h)], &o = points_[apex(h)], &p = points_[apex(twin_[h])];
            // sin(alpha + beta) < 0 for the angles opposite the edge: together more than pi.
            const double sin_o = (u - o).cross(w - o).norm(), cos_o = (u - o).dot(w - o);
            const double sin_p = (u - p).cross(w - p).norm(), cos_p = (u - p).dot(w - p);
            const double scale = (u - o).norm() * (w - o).norm() * (u - p).norm() * (w - p).norm();
            if (sin_o * cos_p + cos_o * sin_p < -1e-9 * scale && flip(h))
                break;  // both faces are on the list again
        }
    }
}

int SplitMesh::split_vertex(int a, int b) const {
    const auto found = split_.find(edge_key(a, b));
    return found == split_.end() ? none : found->second;
}

}  // namespace pvg
