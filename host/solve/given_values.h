// The numbers that a Poisson problem is solved for, apart from its geometry: what holds at knots, jumps across couplings
// and multiplies source columns. The same domain is solved for its own values and, one column each, for its controls.
#pragma once

#include <span>
#include <utility>

#include <Eigen/Core>

#include "curves/domain.h"
#include "solve/knots.h"

namespace pvg {

/// N knots, C channels.
struct GivenValues {
    Eigen::MatrixXd fixed;   ///< N x C; rows of knots that no diffusion curve fixes are 0
    Eigen::MatrixXd jump;    ///< couplings x C
    Eigen::MatrixXd source;  ///< source columns x C
};

/// What the domain holds now. knot_vertex: the vertex of each knot.
GivenValues given_values(const Domain& domain, std::span<const int> knot_vertex);

/// What the stops of these controls give alone, each at the value 1: one column a (control, stop).
GivenValues unit_values(const Domain& domain, const Knots& knots, std::span<const std::pair<int, int>> stops);

/// What controls[control] (the domain's own, or the same with other stops) gives alone, C channels.
GivenValues values_of_control(const Domain& domain, const Knots& knots, int control, const Control& values);

}  // namespace pvg
