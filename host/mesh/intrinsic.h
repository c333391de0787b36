// Intrinsic triangulation: the same surface, other edges. Edge flips on lengths make it Delaunay (Bobenko and Springborn, 2007;
// Sharp et al., "Navigating intrinsic triangulations", 2019), and the cotan stiffness assembled on it has non-negative weights.
#pragma once

#include <array>
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

/// Positive semi-definite cotan stiffness S (V x V) and lumped vertex areas a (V).
Eigen::SparseMatrix<double> cotan_stiffness(const IntrinsicTriangulation& triangulation, int vertex_count);
Eigen::VectorXd lumped_areas(const IntrinsicTriangulation& triangulation, int vertex_count);

}  // namespace pvg
