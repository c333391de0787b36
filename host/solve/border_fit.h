// The flux through a patch's outer border, fitted to the knots of its list: regularised least squares, nearer knots weighing
// more.
#pragma once

#include "solve/patch.h"

namespace pvg {

struct FitOptions {
    double penalty = 1e-5;  ///< on the square of the degree-2 coefficients, relative to the data
    double growth = 4;      ///< factor of the penalty from each degree to the next
    double curves =
        1e-3;  ///< weight of the Dirichlet values as samples of the polynomials: it decides only what the free knots leave open
    double falloff = 3;  ///< data weight 1 / (1 + (falloff r / radius)^2)^2
};

/// Weights of the patch's list for the vertices of its cell: cell vertices x list. Rows sum to 1 over the knots.
RowMatrix fitted_rows(const Patch& patch, const FitOptions& options);

}  // namespace pvg
