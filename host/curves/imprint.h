// Imprinting: every triangle that a curve crosses is split along it, so that the curve becomes a chain of mesh edges.
// Curves are imprinted one after another into the already split mesh; all of them are paths on the parent surface.
#pragma once

#include <functional>
#include <vector>

#include "geodesic/paths.h"
#include "mesh/surface.h"
#include "mesh/surface_map.h"

namespace pvg {

/// An imprinted curve: vertices of the imprinted surface in the order of travel, each joined to the next by an edge.
/// Edges that later curves split stay part of it (the new vertices appear in the chain).
struct CurveChain {
    std::vector<int> vertices;  ///< closed: the first is not repeated
    std::vector<double> t;      ///< per vertex, ascending in [0, 1]; closed: the first has 0
    bool closed = false;
};

/// A dynamic mesh that starts as a copy of the parent.
class Imprinter {
public:
    explicit Imprinter(const Surface& parent);
    ~Imprinter();
    Imprinter(Imprinter&&) noexcept;
    Imprinter& operator=(Imprinter&&) noexcept;

    /// Imprints a path on the PARENT surface; t gives each path point's parameter (same length as path.points). Returns the chain's
    /// number. A crossing nearer than 0.05 x the shortest incident edge to a vertex snaps to it.
    int imprint(const SurfacePath& path, const std::vector<double>& t);

    /// The current surface, its map to the parent, and all chains so far. May be called between imprints.
    RefinedSurface surface() const;
    CurveChain chain(int number) const;

private:
    struct State;
    State* state_;
};

}  // namespace pvg
