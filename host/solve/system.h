// The sparse system for the control coefficients: K lambda = -integral of f over each cell, K = diag(sum w) - W
// (weights |e| / d >= 0). Dirichlet knots are eliminated, the two copies of a sharp Poisson curve are
// one unknown with a known jump. Factored once; all channels are solved together.
#pragma once

#include <memory>

#include <Eigen/Core>

#include "curves/domain.h"
#include "solve/given_values.h"
#include "solve/knots.h"
#include "solve/voronoi.h"

namespace pvg {

class System {
public:
    /// Factors. Throws Error(bad_input) naming the primitive when a part with sources has no Dirichlet value.
    System(const Domain& domain, const Knots& knots, const Voronoi& voronoi);
    ~System();
    System(System&&) noexcept;
    System& operator=(System&&) noexcept;

    /// Unknowns after elimination.
    int unknowns() const;
    /// lambda (N x C) from the values that the domain holds NOW (Dirichlet, jumps, source values): one back-substitution.
    Eigen::MatrixXd solve(const Domain& domain) const;
    /// lambda (N x C) for these values on the same domain; couplings are the domain's.
    Eigen::MatrixXd solve(const Domain& domain, const GivenValues& given) const;
    /// E K^-1 E^T r (N x C), E from the unknowns to all knots: 0 at fixed knots, equal at the two copies of a sharp Poisson
    /// curve.
    Eigen::MatrixXd apply_inverse(const Eigen::MatrixXd& residual) const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace pvg
