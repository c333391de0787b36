// One domain's field by one of the three bases: its table and what the table is evaluated with.
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

#include "pvg/program.h"
#include "scene/scene.h"
#include "solve/galerkin_matrix.h"
#include "solve/patch_space.h"
#include "solve/system.h"
#include "solve/voronoi.h"

namespace pvg {

struct BasisChoice {
    BasisKind kind = BasisKind::local;
    int rings = 2;
    bool normalize = true;  ///< green: truncated rows are divided by their sum
};

struct FieldOptions {
    int threads = 0;  ///< 0: all cores; the result does not depend on it
    /// Called with the part of the basis that is done, on the calling thread only.
    std::function<void(double)> on_progress = {};
};

/// The table of a basis. local, green: coefficients are the knots, then the source columns. exact: no basis but the identity, in
/// cells of up to four rows; coefficients are the vertices' values themselves, in the order of rows.
Table basis_table(const PatchSpace& space, const Voronoi& voronoi, const BasisChoice& choice, const FieldOptions& options);

/// What a table is evaluated with, for the values that the domain holds now.
struct Coefficients {
    Eigen::MatrixXd lambda;     ///< N x C: the knots' control coefficients
    Eigen::MatrixXd unbounded;  ///< N x C: the same before they were put between the curves' values (solve/bounds.h)
    std::vector<float> values;  ///< Field::coefficients
    GalerkinMatrix matrix;      ///< local: what lambda is optimal for
};

/// From the cell system's lambda. local: the energy-optimal ones (solve/galerkin.h). green, exact: the cell system's own, which
/// the paper's formula asks for; exact: the untruncated sum, Dirichlet vertices and copies on sharp Poisson curves at their
/// knot's value.
Coefficients solve_coefficients(const PatchSpace& space, const Voronoi& voronoi, const System& system, const Table& table,
                                const BasisChoice& choice, const Eigen::MatrixXd& cell_lambda, int threads = 0);

/// lambda (N x C), then source values (sources x C), as Field::coefficients has them.
std::vector<float> coefficient_values(const Eigen::MatrixXd& lambda, const Eigen::MatrixXd& source);

}  // namespace pvg
