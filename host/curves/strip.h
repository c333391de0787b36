// Poisson curves with a width: opposite Laplacians on two strips along the curve, so that the field climbs
// by J from the right strip's outer border to the left one's and nothing else changes.
#pragma once

#include <utility>
#include <vector>

#include "curves/imprint.h"
#include "mesh/surface.h"

namespace pvg {

/// The strips' outer borders, as paths on the drawn surface itself: all points at distance `width` from the curve.
std::vector<SurfacePath> strip_borders(const Surface& drawn, const CurveChain& curve, double width);

/// The Laplacians for a jump that is 1 at one stop and falls to 0 at its neighbours, one a stop, as (face, value), ascending.
/// borders: the imprinted outer borders. Per piece of the curve f_left = -J / (m_left + m_right a_left / a_right), f_right =
/// -f_left a_left / a_right, with a a strip's area and m its first moment about the curve, both per unit length, so each piece
/// integrates to 0; then changed as little as possible so that outside the strips the field is that of the sharp jump
/// (level_outside.h). Beyond an open end there is no strip.
std::vector<std::vector<std::pair<int, double>>> strip_profiles(const Surface& imprinted, const CurveChain& curve,
                                                                const std::vector<CurveChain>& borders, double width,
                                                                const std::vector<double>& stops);

}  // namespace pvg
