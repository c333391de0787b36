// Poisson regions: f inside, and in a ring just inside the border the reverse, so that the bump stays inside.
#pragma once

#include <utility>
#include <vector>

#include "curves/imprint.h"
#include "mesh/surface.h"

namespace pvg {

/// The ring's inner borders, as paths on the drawn surface itself: all points at `width` = ring x (largest distance of an inside
/// point) from the border.
std::vector<SurfacePath> ring_borders(const Surface& drawn, const CurveChain& border, double ring, double* width = nullptr);

/// The region's Laplacian for f = 1 inside, as (face, value), ascending. inner: the imprinted inner borders, empty for a region
/// without a ring. Each piece of the ring takes minus the flux that the inner problem (Delta v = 1, v = 0 on the inner border)
/// sends through its stretch of that border; the pieces are then adjusted until the region's own problem (u = 0 on its border)
/// sends no flux out (level_outside.h) and the field is flat outside. Integrates to 0. peak: the largest |u| of the region's own
/// problem.
std::vector<std::pair<int, double>> region_profile(const Surface& imprinted, const CurveChain& border,
                                                   const std::vector<CurveChain>& inner, double* peak);

}  // namespace pvg
