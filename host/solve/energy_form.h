// The finite-element side of a domain, by vertex: what the energy of its fields is made of.
#pragma once

#include <utility>
#include <vector>

#include <Eigen/SparseCore>

#include "curves/domain.h"
#include "mesh/border_points.h"

namespace pvg {

/// V vertices.
struct EnergyForm {
    Eigen::SparseMatrix<double> S;  ///< V x V stiffness of the whole domain (mesh/border_points.h): no negative weights
    std::vector<int> load_first;    ///< V + 1
    std::vector<std::pair<int, double>> loads;  ///< per vertex: (source, integral of its unit profile times the hat function)
};

/// Which border edges of a domain have given ends, and which pairs of them are the two sides of a sharp Poisson curve.
BorderConditions border_conditions(const Domain& domain);

EnergyForm energy_form(const Domain& domain);

}  // namespace pvg
