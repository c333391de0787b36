// The oracle's own points on the border: where a border side's cotangent weight is negative although all flips are done, the
// side gets a real vertex below the opposite corner, with an unknown of its own. Rounds of flips and of all feet at once, so that
// the points depend on the surface alone.
// Source: H. Edelsbrunner, T. S. Tan, "An upper bound for conforming Delaunay triangulations", 1993 (feet of perpendiculars).
#pragma once

#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include "cpu_reference/delaunay_flips.h"

namespace pvg {

/// A vertex on the border side from -> to of the given triangles: (1 - at) from + at to. Vertex number: the count of given
/// vertices plus its place in the list.
struct AddedVertex {
    int from = -1;
    int to = -1;
    double at = 0;
    int across = -1;  ///< number of the vertex at the same place on the other bank of a seam, or -1
};

/// A directed border side, and what is known about it.
using Side = std::pair<int, int>;
struct Border {
    std::map<Side, Side> seams;  ///< the other bank of a side across which the field goes on (with a jump); both ways
    std::vector<bool> held;      ///< per vertex: has a Dirichlet value. Sides between two such vertices are left as they are
};

/// Flips and adds vertices until no free side faces an obtuse angle, and no seam two angles that sum to more than pi. Throws
/// std::runtime_error when it does not come to an end.
std::vector<AddedVertex> refine_border(LengthMesh& mesh, const Border& border);

}  // namespace pvg
