// Slitting: a surface cut open along some of its edges, one copy of a vertex for each sector of faces that is left
// around it, and optionally restricted to some of its faces.
#pragma once

#include <span>
#include <vector>

#include "mesh/surface.h"

namespace pvg {

/// A cut surface. Faces stand in the parent's order with the parent's corner order.
struct SlitSurface {
    Surface surface;
    std::vector<int> vertex_parent;  ///< per vertex: the parent's vertex
    std::vector<int> face_parent;    ///< per face: the parent's face, ascending
};

/// slit: one flag a halfedge of the parent (a flag on either of two twins cuts their edge), or empty. keep: one flag a face, or
/// empty for all. Numbers: the first copy of each parent vertex in the parent's order (so without cuts nothing is renumbered),
/// then all further copies. The first copy is the sector of the vertex's outgoing halfedge. An edge both of whose ends have one
/// copy only stays joined.
SlitSurface slit_surface(const Surface& parent, std::span<const char> slit, std::span<const char> keep = {});

}  // namespace pvg
