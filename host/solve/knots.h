// Knots: the Voronoi sites of a domain. Every vertex on a curve or on the domain's border is one; the rest is filled
// by a greedy Poisson-disk sampling in geodesic distance with the sizing field
//   h(x) = clamp(grading * distance to the nearest curve, a quarter of the input mesh's local edge length, spacing),
// and h <= feature_grading * distance to features (tips, crossings).
#pragma once

#include <vector>

#include "curves/domain.h"

namespace pvg {

struct KnotOptions {
    double spacing = 0;  ///< mesh units
    double grading = 0.25;
    double feature_grading = 0.15;  ///< h <= feature_grading * distance to crossings, meetings and tips
};

struct Knots {
    std::vector<int> vertex;          ///< N: domain vertex of each knot, ascending
    std::vector<int> knot_of_vertex;  ///< V: knot, or none
};

/// Deterministic. Every component of the domain gets at least one knot.
Knots place_knots(const Domain& domain, const KnotOptions& options);

}  // namespace pvg
