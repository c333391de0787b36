// Where the vertices and faces of a refined surface came from: subdivision and imprinting only ever add points
// on faces of their parent, so a vertex is a convex combination of at most three vertices of one parent face.
#pragma once

#include <array>
#include <vector>

#include "mesh/surface.h"

namespace pvg {

/// A vertex as a combination of vertices of the parent surface. Weights > 0 and summing to 1 come first;
/// unused slots hold vertex none and weight 0. An original vertex is {v, none, none}, {1, 0, 0} exactly.
struct VertexOrigin {
    std::array<int, 3> vertex{none, none, none};
    std::array<double, 3> weight{1, 0, 0};
    bool is_vertex() const { return vertex[1] == none; }
};

/// A refined surface's way back to its parent.
struct SurfaceMap {
    std::vector<VertexOrigin> vertex;  ///< per vertex; all its vertices lie on one parent face
    std::vector<int> face;             ///< per face: the parent face that contains it
};

/// A refined surface and its way back. The parent's vertices keep their numbers and exact positions.
struct RefinedSurface {
    Surface surface;
    SurfaceMap map;
};

SurfaceMap identity_map(const Surface& surface);
/// The map from the grandchild to the grandparent. first: child -> parent, second: grandchild -> child.
SurfaceMap compose(const SurfaceMap& first, const SurfaceMap& second);

}  // namespace pvg
