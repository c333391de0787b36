// The finite-element side of a domain, by vertex: what the energy of its fields is made of.
#pragma once

#include <utility>
#include <vector>

#include <Eigen/SparseCore>

namespace pvg {

/// V vertices.
struct EnergyForm {
    Eigen::SparseMatrix<double> S;  ///< V x V stiffness of the whole domain (mesh/border_points.h): no negative weights
    std::vector<int> load_first;    ///< V + 1
    std::vector<std::pair<int, double>> loads;  ///< per vertex: (source, integral of its unit profile times the hat function)
};

}  // namespace pvg
