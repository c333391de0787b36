// A triangle mesh that can be split and flipped inside the faces of its parent: what imprinting works on. Inside every parent
// face the triangles are the constrained Delaunay triangulation of that flat face (the constraints are the fixed edges), so
// splitting makes no needless slivers (Lawson 1977; Sloan, "A fast algorithm for generating constrained Delaunay triangulations",
// 1993).
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "mesh/surface.h"
#include "mesh/surface_map.h"

namespace pvg {

/// Vertices and faces are only ever added; no vertex moves. The parent's vertices keep their numbers; a parent face that is split
/// keeps its number for one of its parts. Every orientation is decided in barycentric coordinates of the parent face, where
/// points of a parent edge have one coordinate that is exactly 0.
class SplitMesh {
public:
    explicit SplitMesh(const Surface& parent);

    const Surface& parent() const { return parent_; }
    int vertex_count() const { return static_cast<int>(points_.size()); }
    int face_count() const { return static_cast<int>(faces_.size()); }
    const std::vector<Point>& points() const { return points_; }
    const std::vector<Face>& faces() const { return faces_; }
    const std::vector<VertexOrigin>& origins() const { return origins_; }
    const std::vector<int>& face_parents() const { return face_parent_; }

    int from(int halfedge) const { return faces_[halfedge / 3][halfedge % 3]; }
    int to(int halfedge) const { return from(Surface::next(halfedge)); }
    int apex(int halfedge) const { return from(Surface::prev(halfedge)); }
    int twin(int halfedge) const { return twin_[halfedge]; }
    int parent_face(int halfedge) const { return face_parent_[halfedge / 3]; }
    int outgoing(int vertex) const { return outgoing_[vertex]; }
    /// Whether both faces of the edge lie in one parent face.
    bool inside_parent(int halfedge) const {
        return twin_[halfedge] != none && parent_face(twin_[halfedge]) == parent_face(halfedge);
    }
    bool fixed(int halfedge) const { return fixed_[halfedge]; }
    /// A fixed edge is never flipped away; when it is split both halves are fixed.
    void fix(int halfedge);

    /// A halfedge from one vertex to the other or, where the edge is a border, the other way round; none if there is no such
    /// edge.
    int edge_between(int from, int to) const;
    /// Halfedges that leave the vertex in the faces of one parent face, counter-clockwise.
    std::vector<int> fan(int vertex, int parent_face) const;
    /// Length of the shortest edge at the vertex that stays, fixed or on an edge of the parent; infinite where there is none.
    double shortest_edge(int vertex);
    bool stays(int halfedge) const { return fixed_[halfedge] || !inside_parent(halfedge); }

    /// Whether the closed parent face contains the vertex, and its coordinates there.
    bool contains(int parent_face, int vertex) const;
    Eigen::Vector3d bary(int parent_face, int vertex) const;

    /// New vertex at the given coordinates in the face's parent, inside the face (into 3) or on the edge (each side into 2).
    /// Returns it.
    int split_face(int face, const Eigen::Vector3d& bary);
    int split_edge(int halfedge, const Eigen::Vector3d& bary);
    /// Flips an edge that is not fixed and lies inside a parent face if its two triangles make a strictly convex quadrilateral.
    bool flip(int halfedge);
    /// Restores the constrained Delaunay property after splits and flips.
    void make_delaunay();

    /// The vertex that a fixed edge was split at, or none.
    int split_vertex(int a, int b) const;

private:
    int add_vertex(int parent_face, const Eigen::Vector3d& bary);
    int add_face(int parent_face);
    void link(int h, int t);
    void claim(int h);
    void renew(int face);
    void shorten(int halfedge);

    Surface parent_;
    std::vector<Point> points_;
    std::vector<VertexOrigin> origins_;
    std::vector<Face> faces_;
    std::vector<int> face_parent_;
    std::vector<int> twin_;
    std::vector<char> fixed_;
    std::vector<int> outgoing_;     ///< as Surface::outgoing
    std::vector<double> shortest_;  ///< 0: not asked for yet
    std::vector<int> renewed_;      ///< faces changed since the last make_delaunay()
    std::unordered_map<std::uint64_t, int> split_;
};

/// Twice the signed area of a triangle in barycentric coordinates: its share of the parent face; exactly 0 when all lie on one
/// edge of it.
double orientation(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c);

}  // namespace pvg
