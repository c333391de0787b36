// The energy of all fields that a table can show, by its coefficients: with u = Psi lambda + Beta q,
//   A = Psi^T S Psi,   B = Psi^T (S Beta + load),
// and A lambda + B q are the forces that a field leaves on its knots. Every psi is compact, so A is sparse (some eighty entries a
// row); once it is made, no solve needs the vertices any more.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "pvg/table.h"
#include "solve/energy_form.h"

namespace pvg {

/// One row a knot, one column a channel.
using KnotValues = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Rows of a sparse matrix, columns ascending.
struct SparseRows {
    std::vector<std::size_t> first{0};  ///< rows + 1
    std::vector<int> column;
    std::vector<double> value;
    int rows() const { return static_cast<int>(first.size()) - 1; }
};

struct GalerkinMatrix {
    SparseRows A;  ///< N x N, symmetric, positive semi-definite; rows sum to 0 up to the rounding of the table's weights
    SparseRows B;  ///< N x source columns
};

/// Requires a table over the first `knots` coefficients as knots, then sources, and the form of the same domain. threads: 0 for
/// all cores; the result does not depend on it.
GalerkinMatrix galerkin_matrix(const EnergyForm& form, const Table& table, int knots, int threads);

/// y = M x. Sizes of y are set.
void multiply(const SparseRows& M, const KnotValues& x, KnotValues& y, int threads);

}  // namespace pvg
