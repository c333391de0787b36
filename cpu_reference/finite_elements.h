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
    struct Jump {
        int left;
        int right;
        Eigen::RowVectorXd value;
    };
    std::vector<Jump> jumps;    ///< u(left) = u(right) + value
    Eigen::MatrixXd laplacian;  ///< F x C: f on each face; 0 x 0 means none
};

/// What the stiffness matrix is assembled on.
enum class FemTriangulation {
    intrinsic_delaunay,  ///< the same surface, edges flipped on lengths and the border given points of its own, where it faces
                         ///< obtuse angles (border_refinement.h): slivers do not spoil the elements
    as_given,            ///< the faces themselves
};

/// u (V x C). Vertices in components without a Dirichlet value are 0 (a jump connects components). Where a jump and Dirichlet
/// values meet, a vertex's own Dirichlet value wins. Throws std::runtime_error when the factorisation fails, and for
/// sizes or vertices that do not exist.
Eigen::MatrixXd solve_finite_elements(const FemProblem& problem,
                                      FemTriangulation triangulation = FemTriangulation::intrinsic_delaunay);

/// What errors are measured against, per channel: the truth's range over the solved vertices, those in a component with a
/// Dirichlet value. A channel whose range is only rounding (below 1e-9 of its largest magnitude) is constant, and its scale is
/// that magnitude. 0 where the truth is 0.
Eigen::RowVectorXd error_scale(const FemProblem& problem, const Eigen::MatrixXd& truth);

/// Errors of `values` against `truth`, both V x C, over the solved vertices, in % of error_scale, per channel; h1 in % of the
/// truth's energy norm or, where that is only rounding, of the norm that errors as large as the truth would have if they were
/// independent. Where the scale is 0, 0 if the error is 0, else infinite.
struct FieldError {
    double mean = 0;  ///< area-weighted
    double max = 0;
    double h1 = 0;  ///< relative energy norm of the error, %
};
std::vector<FieldError> compare_fields(const FemProblem& problem, const Eigen::MatrixXd& truth, const Eigen::MatrixXd& values,
                                       FemTriangulation triangulation = FemTriangulation::intrinsic_delaunay);

}  // namespace pvg
