// What pvg is measured against: what a user of the same mesh would do without it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "curves/domain.h"
#include "solve/energy_form.h"

namespace pvg::bench {

/// The finite-element system of a domain over its free unknowns: A x = b(values), u = P x + g(values).
/// V vertices, n unknowns, C channels.
struct LinearSystem {
    Eigen::SparseMatrix<double> A;  ///< n x n, symmetric positive definite, both triangles
    Eigen::SparseMatrix<double> P;  ///< V x n: the two copies on a sharp Poisson curve share an unknown
    Eigen::MatrixXd b;              ///< n x C, of the values that the domain holds
    Eigen::MatrixXd g;              ///< V x C: fixed values and jumps
};
LinearSystem linear_system(const Domain& domain, const EnergyForm& form);

/// CHOLMOD's supernodal factorisation (T. A. Davis and others) on the system's BLAS.
class Cholmod {
public:
    explicit Cholmod(const Eigen::SparseMatrix<double>& A);
    ~Cholmod();
    Cholmod(const Cholmod&) = delete;
    Cholmod& operator=(const Cholmod&) = delete;

    /// Ordering, symbolic and numerical factorisation from scratch, as an edit of a shape asks for.
    void refactor();
    /// All right-hand sides as one block, with the factor and the workspace kept.
    void solve(const Eigen::MatrixXd& b);
    Eigen::MatrixXd solution() const;
    /// What BLAS was found at run time.
    static std::string blas();

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Bytes a second that two reads and one write of large arrays reach (J. D. McCalpin's triad), with that many threads.
double triad_bytes_per_second(int threads);

/// CGAL's exact geodesics from all sources to all vertices. Returns distances.
std::vector<double> cgal_distances(const Surface& surface, const std::vector<int>& sources);

}  // namespace pvg::bench
