// Energy-optimal control coefficients. The cell system K lambda = load balances each cell with two-point fluxes; the basis
// knows the field between the knots better than that. Of all fields u = Psi lambda + Beta f that a table can show, the one
// nearest to the finite-element solution in the energy norm leaves forces orthogonal to every psi (Galerkin's condition):
//   Psi^T (S u + load) = 0.
// It is reached from the cell system's lambda by conjugate gradients (M. R. Hestenes and E. Stiefel, 1952) with K, factored
// already, as preconditioner: the two operators differ by what two-point fluxes neglect, so a few steps gain nearly all
// (cpu_reference/ACCURACY.md).
#pragma once

#include <Eigen/Core>

#include "pvg/table.h"
#include "solve/galerkin_matrix.h"
#include "solve/patch_space.h"
#include "solve/system.h"

namespace pvg {

struct GalerkinOptions {
    int max_steps = 64;
    double reduction = 1e-6;  ///< a channel rests when its residual, in the norm of K^-1, has fallen by this factor,
    int steps = 24;           ///< or after so many steps
    double settled = 3e-5;    ///< if none of the last three changed a lambda by more than this share of their range
    int threads = 0;          ///< 0: all cores; the result does not depend on it
    bool bounded = true;      ///< between the curves' values where there is neither source nor jump (solve/bounds.h)
};

/// Improves lambda (N x C) in place for the source coefficients `source` (sources x C); fixed knots and jumps stay, nothing is
/// bounded. Returns the steps taken. Deterministic.
int minimise_energy(const GalerkinMatrix& matrix, const System& system, const Eigen::MatrixXd& source,
                    const GalerkinOptions& options, Eigen::MatrixXd& lambda);

/// The same for the values that the domain holds now, and within bounds where the options ask for it. Requires the space, table
/// (over the space's knots, then its sources) and system of one domain.
int minimise_energy(const PatchSpace& space, const Table& table, const System& system, const GalerkinOptions& options,
                    Eigen::MatrixXd& lambda);

}  // namespace pvg
