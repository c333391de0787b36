// The maximum principle, kept by the control coefficients: a field without sources and jumps lies between the least and the
// largest of the values that its part's curves give, and so do the finite-element solution (no weight of the stiffness is
// negative, mesh/border_points.h) and the cell system's lambda (its weights are |e| / d). Energy-optimal coefficients may leave
// the bounds by their own small error. Putting them back is no new error: the truth lies within, so at every knot its distance
// from the truth can only fall, and equal bounds make a constant exact.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "curves/domain.h"
#include "solve/knots.h"

namespace pvg {

/// Per vertex of the domain: its part's number, or none where it has no face. Parts stand in the order of their first vertex.
std::vector<int> number_parts(const Domain& domain, int& count);

/// Bounds of the values that the domain holds now. P parts: components of the surface, joined by couplings; C channels. A channel
/// of a part with a source, a jump or no given value is not bounded: -infinity and infinity.
struct PartBounds {
    std::vector<int> part;  ///< V: none where a vertex has no face
    Eigen::MatrixXd low;    ///< P x C
    Eigen::MatrixXd high;   ///< P x C
};
PartBounds part_bounds(const Domain& domain);

/// Moves lambda (N x C) between the bounds. Returns the largest move.
double keep_between_bounds(const Domain& domain, const Knots& knots, Eigen::MatrixXd& lambda);

}  // namespace pvg
