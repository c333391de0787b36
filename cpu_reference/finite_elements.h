// The oracle: linear finite elements on the decorated mesh's own vertices, in double, with Dirichlet rows at the
// diffusion curves. It assembles its own operator and constraints and shares no code with what it judges.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace pvg {

/// A Poisson problem as plain arrays. V vertices, F faces, C channels. Slits are already cut (own vertices a side).
struct FemProblem {
    std::vector<Eigen::Vector3d> points;
    std::vector<std::array<int, 3>> faces;
    std::vector<std::pair<int, Eigen::RowVectorXd>> dirichlet;  ///< vertex, C values
    struct Jump { int left; int right; Eigen::RowVectorXd value; };
    std::vector<Jump> jumps;                                    ///< u(left) = u(right) + value
    Eigen::MatrixXd laplacian;                                  ///< F x C: f on each face
};

/// u (V x C). Vertices in components without a Dirichlet value are 0. Throws std::runtime_error when the factorisation fails.
Eigen::MatrixXd solve_finite_elements(const FemProblem& problem);

/// Errors of `values` against `truth`, both V x C, in % of the truth's range over the solved vertices, per channel.
struct FieldError {
    double mean = 0;  ///< area-weighted
    double max = 0;
    double h1 = 0;    ///< relative energy norm of the error, %
};
std::vector<FieldError> compare_fields(const FemProblem& problem, const Eigen::MatrixXd& truth, const Eigen::MatrixXd& values);

}  // namespace pvg
