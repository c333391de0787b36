// The exact geodesic Voronoi diagram of the knots on a slit domain: cells, areas, bisectors and the dual's weights.
// Bisectors are clipped in every face from the exact distance windows, not marched over vertex labels.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "curves/domain.h"
#include "solve/knots.h"

namespace pvg {

/// A part of a face that belongs to one cell.
struct CellPiece {
    int face = none;
    int cell = none;
    double area = 0;
};

/// Two adjacent cells a < b, all their common arcs together.
struct CellEdge {
    int a = none;
    int b = none;
    double weight = 0;    ///< w_ab = sum over arcs of |e| / d >= 0
    double length = 0;    ///< sum of |e|, mesh units
    double distance = 0;  ///< shortest d over the arcs, mesh units
};

struct Voronoi {
    std::vector<int> cell;             ///< V: the nearest knot (vertices without faces: none)
    std::vector<double> distance;      ///< V: to it
    std::vector<double> direction;     ///< V: log map at the knot, as in GeodesicField
    std::vector<double> area;          ///< N: exact; sums to the domain's area
    std::vector<CellPiece> pieces;     ///< sorted by face, then cell; areas sum to the face's
    std::vector<CellEdge> edges;       ///< sorted by (a, b)
    std::vector<int> neighbour_first;  ///< N + 1
    std::vector<int> neighbours;       ///< adjacency of cells, ascending; from edges
};

Voronoi geodesic_voronoi(const Domain& domain, const Knots& knots);

}  // namespace pvg
