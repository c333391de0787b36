// Intrinsic triangulation: the same surface, other edges. Edge flips on lengths make it Delaunay (Bobenko and Springborn, 2007;
// Sharp et al., "Navigating intrinsic triangulations", 2019), and the cotan stiffness assembled on it has non-negative weights.
#pragma once

#include <array>
#include <span>
#include <vector>

#include <Eigen/SparseCore>

#include "mesh/surface.h"

namespace pvg {

/// Triangles over the surface's vertices with edge lengths instead of positions. An edge may join a vertex to itself.
struct IntrinsicTriangulation {
    std::vector<std::array<int, 3>> faces;       ///< vertices
    std::vector<std::array<double, 3>> lengths;  ///< length of the edge from corner k to corner k + 1
    std::vector<int> twin;                       ///< per halfedge 3 f + k, or none
};

IntrinsicTriangulation intrinsic_triangulation(const Surface& surface);
/// Flips edges until all are Delaunay (opposite angles sum to at most pi). Border edges stay. Deterministic. Returns the number
/// of flips.
int make_delaunay(IntrinsicTriangulation& triangulation);
/// The same where only these halfedges and what their flips touch may need it.
int make_delaunay(IntrinsicTriangulation& triangulation, std::span<const int> halfedges);

/// Area of a triangle from its edge lengths, 0 where rounding breaks the triangle inequality.
double triangle_area(const std::array<double, 3>& lengths);

/// The angle opposite a halfedge in its face: sine and cosine, both times `scale`, the product of the two adjacent lengths.
struct OppositeAngle {
    double sine = 0;
    double cosine = 0;
    double scale = 0;
};
OppositeAngle opposite_angle(const IntrinsicTriangulation& triangulation, int halfedge);

/// Positive semi-definite cotan stiffness S (V x V) and lumped vertex areas a (V).
Eigen::SparseMatrix<double> cotan_stiffness(const IntrinsicTriangulation& triangulation, int vertex_count);
Eigen::VectorXd lumped_areas(const IntrinsicTriangulation& triangulation, int vertex_count);

}  // namespace pvg
