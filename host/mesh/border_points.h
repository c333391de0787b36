// Points on the border of an intrinsic triangulation, so that the cotan stiffness has no negative weight there either.
//
// Flips make every inner weight non-negative; a border edge cannot flip, and one that faces an obtuse angle keeps its negative
// weight. It is split at the foot of the opposite corner, which makes two right triangles of the obtuse one, and the triangles
// are flipped again, in rounds, until no border edge faces an obtuse angle (Bobenko and Springborn, 2007, for the flips; the feet
// after H. Edelsbrunner and T. S. Tan, "An upper bound for conforming Delaunay triangulations", 1993: between two sides that meet
// at a small angle, where midpoints never end, the foot of a foot lies on the circle over its edge and ends the chain at once).
//
// The new points are not unknowns of anybody else; they are eliminated again, and the stiffness stays V x V:
// - Free border (natural condition). The point is free too, so it takes the value of least energy: a Schur complement. With
//   negative off-diagonals and zero row sums before, both hold after: -S_iq S_qj / S_qq <= 0, and S_qq is minus the row's rest.
//   A linear function that the free border allows (no flux through it) keeps zero forces, as on the finer triangulation.
// - Edge with two fixed ends. The value between them is linear by the definition of a curve, so a point there is no new freedom:
//   P^T S P is, until something flips, the matrix without the point. Nor is one needed: the edge's weight acts between two given
//   values. Such edges are not split; a weight between two fixed vertices is put to 0 where it would be negative, and Schur
//   complements leave out what they would add between two of them. No solution and no force on a free vertex changes.
// - The two sides of a sharp Poisson curve, u = q on one and q + J on the other. Both get their point at the same place when
//   the weights of both together are negative. J is linear between the curve's vertices, J = (1 - t)(u_a - u_a') + t (u_b -
//   u_b'), a function of the vertices; q is free. What the two sides share is one unknown, and between those no weight is
//   negative.
#pragma once

#include <vector>

#include <Eigen/SparseCore>

#include "mesh/intrinsic.h"

namespace pvg {

/// What holds along the border, V vertices. One border edge leaves each border vertex.
struct BorderConditions {
    std::vector<char> fixed;      ///< V: 1 where the value is given. Empty: nowhere
    std::vector<int> other_side;  ///< V: of the border edge that leaves here, the vertex that its other side leaves (sharp
                                  ///< Poisson curve), or none. Mutual. Empty: nowhere
};

/// A point on a border edge of the surface, vertex number V + its place in the list.
struct BorderPoint {
    int from = none;  ///< the edge's ends
    int to = none;
    double share = 0;  ///< (0, 1), from `from`
    int other = none;  ///< the list's point at the same place of the other side, or none
};

/// Flips and splits until every weight but those between two fixed vertices is non-negative. Gives up after 8 points a border
/// edge on average (never seen). Deterministic; the points do not depend on the order of faces but for cocircular corners.
std::vector<BorderPoint> insert_border_points(IntrinsicTriangulation& triangulation, const Surface& surface,
                                              const BorderConditions& border);

/// V x V stiffness of the surface: symmetric, positive semi-definite, rows sum to 0, off-diagonals <= 0 (between the unknowns
/// that sharp Poisson curves leave).
Eigen::SparseMatrix<double> surface_stiffness(const Surface& surface, const BorderConditions& border);

}  // namespace pvg
