// The default basis: local Green's functions. For each cell a patch of the cells around it, cut at slits and borders, is
// factored once. Its own Green's columns, and the flux of low harmonic degree through its outer border that fits the knots best,
// give for every vertex of the cell one row of weights over the coefficients (knots' lambda, then source columns). Rows sum to 1
// over the knots. cpu_reference/ACCURACY.md has what was measured.
#pragma once

#include "pvg/table.h"
#include "solve/border_fit.h"
#include "solve/patch_space.h"

namespace pvg {

struct BasisOptions {
    int rings = 2;
    int threads = 0;  ///< 0: all cores. The result does not depend on it, bit for bit.
};

/// What BasisOptions leaves to measurements (cpu_reference/ACCURACY.md).
struct BasisTuning {
    PatchOptions patch;
    FitOptions fit;
    bool exact_knots = true;  ///< a cell whose only vertex is its knot takes lambda itself
};

/// The table of one domain: rows are its vertices, coefficients its knots then its sources.
Table local_basis(const PatchSpace& space, const BasisOptions& options);
/// The same, tuned: tuning.patch.rings counts, options.rings does not.
Table local_basis(const PatchSpace& space, const BasisOptions& options, const BasisTuning& tuning);

}  // namespace pvg
