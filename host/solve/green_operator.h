// Green's function of a whole slit domain with natural borders, as an operator: x = S^+ q answers charges q on the vertices,
// S x = q, with the area mean of x removed on each connected component. On a closed surface the charges e_y - a / A_M give
// -phi_y of the paper (C.-W. Fu et al., "Decorating 3D models with Poisson vector graphics", 2018, whose "A^-1 L G = I - 1 1^T /
// n" has no solution unless all vertex areas are equal). S is factored once, one vertex of each component pinned (L D L^T: T.
// Davis, "Direct Methods for Sparse Linear Systems", 2006, chapter 4).
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "solve/envelope.h"
#include "mesh/surface.h"

namespace pvg {

/// Read-only once made, so that threads may share it. V vertices.
class GreenOperator {
public:
    /// Factors. Throws Error(bad_input) where the surface is too badly triangulated.
    explicit GreenOperator(const Surface& surface);
    ~GreenOperator();
    GreenOperator(const GreenOperator&) = delete;

    /// Connected component of a vertex, or none: it has no face.
    int component(int vertex) const { return component_[vertex]; }
    int component_count() const { return static_cast<int>(component_area_.size()); }
    /// V x V: natural on curves too, whose vertices are unknowns here; what flows through them comes as charges.
    const Eigen::SparseMatrix<double>& stiffness() const { return S_; }
    /// V: on the intrinsic Delaunay triangulation.
    const Eigen::VectorXd& lumped_area() const { return lumped_area_; }
    /// Sum of the lumped areas.
    double component_area(int component) const { return component_area_[component]; }

    /// Charges become potentials, in place: V x B, B a multiple of 4, one problem a column. Charges of a column must sum to zero
    /// on each component; what rounding leaves of the sum flows off through the pinned vertex. A column's result does not depend
    /// on the others, bit for bit. work: a buffer, kept by the caller between calls; it grows to V x B.
    void apply(RowMatrix& columns, RowMatrix& work) const;

private:
    void remove_means(RowMatrix& columns) const;

    struct Factor;
    std::vector<int> component_;          // V
    std::vector<double> component_area_;  // by component
    Eigen::VectorXd lumped_area_;         // V
    Eigen::SparseMatrix<double> S_;
    std::vector<int> place_;  // V: row of the permuted factor, or none (pinned, or without faces)
    std::unique_ptr<Factor> factor_;
};

}  // namespace pvg
