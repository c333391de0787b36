// The oracle's own intrinsic Delaunay triangulation: edge lengths and flips, as plain as can be.
// Source: M. Fisher, B. Springborn, A. Bobenko, P. Schroeder, "An algorithm for the construction of intrinsic Delaunay
// triangulations with applications to digital geometry processing", 2007.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

namespace pvg {

/// Triangles with lengths: side k of a triangle runs from vertex k to vertex k + 1 (modulo 3).
struct LengthMesh {
    std::vector<std::array<int, 3>> vertices;
    std::vector<std::array<double, 3>> lengths;
    std::vector<std::array<int, 3>> twins;  ///< 3 * triangle + side across each side; -1 at a border or where more than two meet
};

/// Lengths are enlarged by one common tiny amount where a triangle is so flat that they would break the triangle inequality.
LengthMesh make_length_mesh(const std::vector<Eigen::Vector3d>& points, const std::vector<std::array<int, 3>>& faces);

/// Flips edges until every one that has a twin is Delaunay (opposite angles sum to at most pi). Returns the number of flips.
/// Throws std::runtime_error when it does not come to an end.
std::size_t flip_to_delaunay(LengthMesh& mesh);

/// Twice the cotangent weight of a side within its own triangle: the cotangent of the opposite angle.
double opposite_cotangent(const std::array<double, 3>& lengths, int side);

}  // namespace pvg
