// Knots: the Voronoi sites of a domain. Every vertex on a curve or on the domain's border is one; the rest is filled
// by a greedy Poisson-disk sampling in geodesic distance with the sizing field
//   h(x) = clamp(grading * distance to the nearest curve, 1 % of the input mesh's local edge length, spacing),
// h <= feature_grading * distance to features (tips, crossings), and h <= sqrt(curvature / |K|) where the surface has Gaussian
// curvature K, growing away from there by the grading: the basis' polynomials live in log-map coordinates, which a cell must not
// bend much (ears and limbs of real meshes; cpu_reference/ACCURACY.md). Bending without stretching (K = 0) costs nothing.
// And h <= most_edges input edges.
#pragma once

#include <vector>

#include "curves/domain.h"

namespace pvg {

struct KnotOptions {
    double spacing = 0;  ///< mesh units
    double grading = 0.25;
    double feature_grading = 0.15;  ///< h <= feature_grading * distance to crossings, meetings and tips
    double curvature = 0.5;  ///< h <= sqrt(curvature / Gaussian curvature): a disk of that radius has pi times this much in all
    /// A cell's patch costs the square of its vertices: with at most about 20 in a cell the whole grows linearly, however fine
    /// the mesh (a million vertices: four times faster than with cells of 750).
    double most_edges = 5;
};

struct Knots {
    std::vector<int> vertex;          ///< N: domain vertex of each knot, ascending
    std::vector<int> knot_of_vertex;  ///< V: knot, or none
};

/// Deterministic. Every component of the domain gets at least one knot.
Knots place_knots(const Domain& domain, const KnotOptions& options);

}  // namespace pvg
