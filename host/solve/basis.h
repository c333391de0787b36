// The default basis: local Green's functions (METHOD 3). For each cell a patch of its neighbours' cells, cut at slits and borders, is factored
// once; border data of low harmonic degree fitted to the knots and the patch's own Green's columns give, for every vertex of the
// cell, one row of weights over the coefficients (knots' lambda, then source columns). Rows sum to 1 over the knots.
#pragma once

#include "curves/domain.h"
#include "pvg/table.h"
#include "solve/knots.h"
#include "solve/voronoi.h"

namespace pvg {

struct BasisOptions {
    int rings = 2;
    int threads = 0;  ///< 0: all cores. The result does not depend on it, bit for bit.
};

/// The table of one domain: rows are its vertices, coefficients its knots then its sources.
Table local_basis(const Domain& domain, const Knots& knots, const Voronoi& voronoi, const BasisOptions& options);

}  // namespace pvg
