// Cholesky factor of a small sparse symmetric matrix in envelope (skyline) storage: for the mesh of a patch, numbered by
// breadth-first levels, it costs n b^2 with a bandwidth b of about the square root of n, without any symbolic work. A. George and
// J. Liu, "Computer Solution of Large Sparse Positive Definite Systems", 1981, chapter 4. Columns are stored, and four of them
// are eliminated at a time (right-looking), so that what they update is read and written once for all four.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace pvg {

/// Dense right-hand sides, one row an unknown.
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Buffers are kept between uses, so one object serves many patches of one thread.
class EnvelopeCholesky {
public:
    /// Starts a matrix of n unknowns, all zero; first_column[i] <= i is the first column of row i that will be added to.
    void begin(const std::vector<int>& first_column);
    /// Adds to entry (row, column) of the lower triangle.
    void add(int row, int column, double value) { values_[start_[column] + static_cast<std::size_t>(row - column)] += value; }
    /// Factors in place. An unknown whose pivot vanishes (relative to its diagonal) is fixed at 0. Returns how many were.
    int factor();
    /// Solves for all columns of X in place. The number of columns must be a multiple of 4.
    void solve(RowMatrix& X) const;

private:
    int size_ = 0;
    std::vector<int> end_;            ///< per column: one past its last row; does not descend
    std::vector<std::size_t> start_;  ///< of each column's values, diagonal first
    std::vector<double> values_, diagonal_;
};

}  // namespace pvg
