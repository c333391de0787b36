// Linear finite elements on a small part of the surface, zero on some of its vertices and natural elsewhere: what the
// profiles of Poisson regions and of wide Poisson curves are computed with. Stiffness on the intrinsic Delaunay triangulation,
// its border edges split where they face obtuse angles.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include "curves/slit.h"
#include "mesh/surface.h"

namespace pvg {

/// V vertices of the part as the parent has them: copies of one parent vertex are one vertex here.
class PatchPoisson {
public:
    /// parent_halfedges: one flag a halfedge of the parent; u = 0 at the ends of flagged edges. Every part of the surface needs
    /// one. Factors; throws Error(bad_input) when that fails.
    PatchPoisson(const SlitSurface& part, int parent_vertices, std::span<const char> zero_halfedges);

    /// The vertex here of a parent vertex, or none.
    int vertex_of(int parent) const { return vertex_[parent]; }
    int vertex_count() const { return static_cast<int>(unknown_.size()); }
    /// How many of them are held at 0.
    int border_count() const { return vertex_count() - unknown_count_; }

    /// Integrals of a function constant on each face of the part over the vertices' hat functions (V).
    Eigen::VectorXd load_of(std::span<const double> face_value) const;
    /// The load that a jump makes: g (vertices of part.surface) is added to u on the copies of each vertex.
    Eigen::VectorXd load_of_jump(const Eigen::VectorXd& g) const;
    /// u (V) with Delta u = f, from load_i = integral of f over vertex i's hat function, so S u = -load at free vertices.
    Eigen::VectorXd solve(const Eigen::VectorXd& load) const;
    /// Outward flux of the gradient through the zero vertices' share of the border: (S u + load)_i; 0 at free vertices. Sums to
    /// the sum of loads.
    Eigen::VectorXd flux(const Eigen::VectorXd& u, const Eigen::VectorXd& load) const;
    /// The harmonic function with the given values (V) at the zero vertices.
    Eigen::VectorXd harmonic(const Eigen::VectorXd& border) const;
    /// Mean over each face of the part of a function's values (V) at its corners.
    std::vector<double> face_means(const Eigen::VectorXd& u) const;

private:
    std::vector<int> vertex_;  // per parent vertex
    std::vector<Face> faces_;  // of the part, by vertices here
    std::vector<double> areas_;
    std::vector<int> here_;                      // per vertex of part.surface
    Eigen::SparseMatrix<double> cut_stiffness_;  // over vertices of part.surface
    Eigen::SparseMatrix<double> stiffness_;      // V x V
    std::vector<int> unknown_;                   // per vertex, or none
    int unknown_count_ = 0;
    std::unique_ptr<Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>> factor_;
};

}  // namespace pvg
