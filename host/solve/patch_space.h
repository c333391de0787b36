// What all patches of a domain share: operator, cells, couplings and loads.
#pragma once

#include <vector>

#include "curves/domain.h"
#include "solve/energy_form.h"
#include "solve/knots.h"
#include "solve/log_map.h"
#include "solve/voronoi.h"

namespace pvg {

/// Read-only once made. V vertices, N cells. The domain and the knots must outlive it.
class PatchSpace : public EnergyForm {
public:
    PatchSpace(const Domain& domain, const Knots& knots, const Voronoi& voronoi);

    const Domain& domain;
    const Knots& knots;
    std::vector<int> partner;          ///< V: the next copy of a vertex on sharp Poisson curves, in a ring, or none
    std::vector<int> right;            ///< V: the copy that a left one's jump stands against, or none
    std::vector<int> neighbour_first;  ///< N + 1: cells that touch or that an edge of S or a sharp Poisson curve joins, ascending
    std::vector<int> neighbours;
    std::vector<int> cell_first;     ///< N + 1
    std::vector<int> cell_vertices;  ///< ascending in each cell
    LogMap log_map;

private:
    void join_cells(const Voronoi& voronoi);
    void sort_vertices(const Voronoi& voronoi);
};

}  // namespace pvg
