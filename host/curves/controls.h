// Sums over controls: where and with which weights the values of a scene make up the numbers of a domain.
#pragma once

#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "curves/domain.h"
#include "scene/scene.h"

namespace pvg {

/// sum += scale * other.
void add_scaled(ControlSum& sum, const ControlSum& other, double scale);

/// Which stops of its control a term reads and with which weights (the term's own included), by the rules of evaluate_stops
/// (scene/scene.h).
StopWeights stops_of(const ControlTerm& term, const Control& control);

/// The sum's value, 1 x channels.
Eigen::RowVectorXd value_of(const ControlSum& sum, std::span<const Control> controls, int channels);

/// The domain's controls with the stops that the scene has for them now: what an edit of values changes. A control whose
/// primitive is not in the scene, is disabled, or has no value for it any more has no stops.
std::vector<Control> controls_of(const Scene& scene, const Domain& domain);

}  // namespace pvg
