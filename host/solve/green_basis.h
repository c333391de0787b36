// The paper's own basis, global Green's columns (C.-W. Fu et al., "Decorating 3D models with Poisson vector graphics", 2018),
// with its formulas corrected, and its untruncated sum. On each connected component M of the slit domain, borders natural:
//   S phibar_j = -(d_j - a / A_M),      psi_j = A_j / A_M + sum_i w_ij (phibar_i - phibar_j),      sum_j psi_j = 1,
// with a the lumped areas, A_j the cell's area, A_M that of M, and d_j the unit charge of cell j. S^+ is linear and columns of K
// sum to zero, hence psi_j = A_j / A_M + S^+ sum_i K_ij d_i: one solve a cell. The untruncated sum costs one solve a channel:
//   sum_j lambda_j psi_j = sum_j lambda_j A_j / A_M + S^+ sum_j (K lambda)_j d_j.
//
// What (K lambda)_j is: what cell j gives off. In a free cell minus the integral of f over it, so sources need no columns of
// their own; at a slit's knot the flux that its Dirichlet value feeds in, or that its sharp Poisson curve carries across. Where
// it goes:
// - In a cell, over its pieces (the paper's cell average): each gives the corners of its face a third of its area. Cells together
//   then give a vertex the integral of its hat function, and a Laplacian that is constant over several cells is exact. (With
//   d_j = a chi_j / A_j, whole vertices, charges are off by the ratio of exact and lumped cell areas.) Cells of one or two
//   vertices are as small as the mesh, or strips of larger faces: they keep their charge to their own vertices.
// - At a Dirichlet vertex and at a copy on a sharp Poisson curve: at that vertex, d_j = e_y.
// The two copies on a sharp Poisson curve are knots of the natural problem on their own side: what flows out of one flows into
// the other, and lambda_left = lambda_right + J stands in both sides' means. So S need not couple them.
//
// phibar_j is known up to a constant on each component, here such that sum_i A_i phibar_j(knot i) = 0: the sum then meets lambda
// on average, whatever quadrature A_j / A_M is. (Removing the area mean instead shifts fields by that quadrature's error.)
//
// "psi decays quickly" does not hold: the tail is algebraic, and truncation costs accuracy (cpu_reference/ACCURACY.md).
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "pvg/table.h"
#include "solve/green_operator.h"
#include "solve/patch_space.h"
#include "solve/voronoi.h"

namespace pvg {

struct GreenOptions {
    int rings = 2;  ///< a row keeps the psi of the cells at most so many cells away (over common borders) from its own
    /// Rows are divided by their sum (one off by more than a factor of 2 takes its own knot's value). Else they are truncated as
    /// they are, which no longer reproduces a constant.
    bool normalize = true;
    int threads = 0;  ///< 0: all cores. Neither threads nor batch changes a byte of the result.
    int batch = 16;   ///< columns that a thread solves together
    /// Called with the part that is done, on the calling thread only.
    std::function<void(double)> on_progress = {};
};

/// Read-only once made. V vertices, N cells, C channels. The space must outlive it.
/// Memory: the factor of S; while a table is built, besides, 8 bytes a pair that it stores and 16 bytes x V x batch a thread.
class GreenBasis {
public:
    GreenBasis(const PatchSpace& space, const Voronoi& voronoi);

    /// d_j: V, sum 1.
    Eigen::VectorXd charge(int cell) const { return charge_.col(cell); }
    /// Untruncated psi of the cells first .. first + count - 1: V x count. 0 on other components.
    Eigen::MatrixXd columns(int first, int count) const;
    /// The untruncated sum of lambda_j psi_j (N x C -> V x C), by one solve a channel.
    Eigen::MatrixXd sum(const Eigen::MatrixXd& lambda) const;
    /// The truncated basis over the space's knots (source columns are listed nowhere). Dirichlet vertices take their own knot's
    /// value.
    Table table(const GreenOptions& options) const;

private:
    struct Neighbour {
        int cell;
        double weight;
    };
    int cells() const { return static_cast<int>(space_.knots.vertex.size()); }
    void spread_charges(const Voronoi& voronoi);
    /// A Dirichlet vertex or a copy on a sharp Poisson curve: all are knots.
    bool on_slit(int vertex) const { return space_.domain.dirichlet[vertex] || space_.partner[vertex] != none; }
    bool point_charge(int cell) const;
    void add_charge(int cell, double amount, RowMatrix& columns, Eigen::Index column) const;
    RowMatrix knot_means(const RowMatrix& columns) const;
    void fill_psi(int first, int count, RowMatrix& columns, RowMatrix& work) const;
    std::vector<int> cells_around(int cell, int rings, std::vector<int>& ring_of_cell) const;

    const PatchSpace& space_;
    GreenOperator inverse_;
    std::vector<int> neighbour_first_;  // N + 1: rows of K without the diagonal
    std::vector<Neighbour> neighbours_;
    Eigen::SparseMatrix<double> charge_;  // V x N: d_j
    std::vector<double> cell_weight_;     // N: A_j / A_M
};

}  // namespace pvg
