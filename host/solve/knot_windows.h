// Exact geodesic distances from all knots together, as windows: straight bundles of geodesics unfolded into the faces that
// they enter (Chen and Han, "Shortest paths on a polyhedron", 1990). Knots are dense, so every bundle dies within a few
// faces: depth-first propagation with the filter of Xin and Wang ("Improving Chen & Han's algorithm on the discrete
// geodesic problem", 2009) against upper bounds of the distance needs no queue. Only pseudo-sources (saddle and reflex
// border vertices) are taken in order of distance.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "mesh/surface.h"

namespace pvg {

/// A bundle that enters a face through a halfedge. In the halfedge's frame (origin at its origin vertex, x along it, y into its
/// face) the knot or pseudo-source unfolds to `source`, y <= 0.
struct KnotWindow {
    int halfedge = none;  ///< of the face that is entered
    int knot = none;
    double begin = 0;  ///< interval on the halfedge, 0 <= begin < end <= length
    double end = 0;
    Eigen::Vector2d source{0, 0};
    double offset = 0;  ///< distance from the knot to the pseudo-source; 0 for the knot itself
    /// Straight lines past the bundle's sides are no paths. Else they are never shorter than the distance: no saddle or
    /// reflex border vertex is near enough to the knot to matter, and unfolding around convex vertices only lengthens.
    bool bounded = false;
};

struct KnotWindows {
    std::vector<double> distance;  ///< V: exact distance to the nearest knot (+infinity where none reaches)
    std::vector<int> knot;         ///< V: that knot (ties: the lower), or none
    /// V: the path's direction at the knot, from Surface::outgoing counter-clockwise in true face angles
    std::vector<double> direction;
    std::vector<char> pseudo_source;  ///< V: 1 for saddle and reflex border vertices that are no knots
    std::vector<KnotWindow> windows;  ///< sorted by halfedge; all that could matter anywhere in the face entered
    std::vector<std::size_t> first;   ///< 3F + 1: windows of halfedge h are first[h] .. first[h + 1] - 1
};

/// knots: vertices, ascending.
KnotWindows knot_windows(const Surface& surface, std::span<const int> knots);

}  // namespace pvg
