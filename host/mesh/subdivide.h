// Midpoint subdivision of the input before it is decorated.
#pragma once

#include "mesh/surface_map.h"

namespace pvg {

/// Every triangle into four, `levels` times.
RefinedSurface subdivide(const Surface& surface, int levels);
/// Edges longer than max_edge are halved (triangles into 2, 3 or 4, no T-junctions) until none is left. Throws Error(bad_input)
/// with the number when more than 50 million vertices are predicted.
RefinedSurface subdivide_to(const Surface& surface, double max_edge);

}  // namespace pvg
