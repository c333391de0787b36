// An oriented manifold triangle surface, open or closed, of any genus and any number of components.
// It is the only mesh type of the numerical stages: the welded input, the imprinted surface and the slit
// domains are all Surfaces. Immutable after construction.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace pvg {

using Point = Eigen::Vector3d;
using Face = std::array<int, 3>;

/// "No such index" everywhere in the library.
inline constexpr int none = -1;

/// A point on a surface: a face and barycentric coordinates in it (>= 0, sum 1, order of the face's corners).
struct SurfacePoint {
    int face = none;
    Eigen::Vector3d bary{1, 0, 0};
};

/// Halfedge h = 3 * face + k runs from corner k to corner (k + 1) % 3 of its face, the face on its left.
/// Corners share the halfedges' numbers: corner 3 * face + k is the origin of halfedge 3 * face + k.
class Surface {
public:
    Surface() = default;

    /// Takes points (V) and faces (F, counter-clockwise seen from outside). Requires: indices in range, no face
    /// with a repeated vertex, no edge with more than two faces or with two equally oriented ones, one fan of
    /// faces a vertex (weld() makes any input so). Throws Error(bad_input) naming the first violation.
    Surface(std::vector<Point> points, std::vector<Face> faces);

    int vertex_count() const { return static_cast<int>(points_.size()); }
    int face_count() const { return static_cast<int>(faces_.size()); }
    int halfedge_count() const { return 3 * face_count(); }

    const std::vector<Point>& points() const { return points_; }
    const std::vector<Face>& faces() const { return faces_; }
    const Point& point(int vertex) const { return points_[vertex]; }
    const Face& face(int face) const { return faces_[face]; }

    static int face_of(int halfedge) { return halfedge / 3; }
    static int next(int halfedge) { return halfedge % 3 == 2 ? halfedge - 2 : halfedge + 1; }
    static int prev(int halfedge) { return halfedge % 3 == 0 ? halfedge + 2 : halfedge - 1; }
    int origin(int halfedge) const { return faces_[halfedge / 3][halfedge % 3]; }
    int target(int halfedge) const { return origin(next(halfedge)); }
    /// The oppositely oriented halfedge of the same edge, or none on a border.
    int twin(int halfedge) const { return twin_[halfedge]; }

    /// A halfedge that leaves the vertex, or none for a vertex without faces. For a border vertex it is the
    /// border halfedge itself, so that h -> twin(prev(h)) visits all faces of the fan counter-clockwise, once.
    int outgoing(int vertex) const { return outgoing_[vertex]; }
    bool is_border_vertex(int vertex) const { return outgoing_[vertex] != none && twin_[outgoing_[vertex]] == none; }

    double length(int halfedge) const { return (points_[target(halfedge)] - points_[origin(halfedge)]).norm(); }
    double face_area(int face) const;
    double area() const;
    /// Unit normal of a face (zero for a face without area).
    Point face_normal(int face) const;
    /// Sum of the face angles at a vertex, in radians.
    double angle_sum(int vertex) const;
    /// The point in space.
    Point position(const SurfacePoint& at) const;
    /// Diagonal of the bounding box of all points that a face uses.
    double diagonal() const;

    /// The halfedge from one vertex to another, or none. O(valence).
    int halfedge_between(int from, int to) const;

private:
    std::vector<Point> points_;
    std::vector<Face> faces_;
    std::vector<int> twin_;
    std::vector<int> outgoing_;
};

/// Connected components over edges. Returns the component of each face, numbered in order of first face.
std::vector<int> face_components(const Surface& surface, int* count = nullptr);

/// Angle-weighted unit normals (V; zero where a vertex has no face).
std::vector<Point> vertex_normals(const Surface& surface);

}  // namespace pvg
