// Whether two scenes draw the same curves: what an edit of values leaves as it is.
#pragma once

#include "scene/scene.h"

namespace pvg {

/// True when all that geometry, knots and bases depend on is equal: mesh, knots, basis, layers, and of each primitive its place,
/// path and widths, which quantities it gives and, on a wide Poisson curve, where its stops are. Colours, heights, Laplacians,
/// other stops, ids, names, blending and the space of diffusion may differ.
bool same_geometry(const Scene& a, const Scene& b);

/// Requires same_geometry. True when the stops of all curves stand at the same parameters: curves have a vertex at each of them,
/// so where they do not, a build of one scene shows the other with its kinks up to an edge off.
bool same_stops(const Scene& a, const Scene& b);

}  // namespace pvg
