// Imprinting: every triangle that a curve crosses is split along it, so that the curve becomes a chain of mesh edges.
// Curves are imprinted one after another into the already split mesh; all of them are paths on the parent surface.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "geodesic/paths.h"
#include "mesh/surface.h"
#include "mesh/surface_map.h"

namespace pvg {

/// An imprinted curve: vertices of the imprinted surface in the order of travel, each joined to the next by an edge.
/// Edges that later curves split stay part of it (the new vertices appear in the chain).
struct CurveChain {
    std::vector<int> vertices;  ///< closed: the first is not repeated
    std::vector<double> t;      ///< per vertex, ascending in [0, 1]; closed: the first has that of the path's first point
    bool closed = false;
};

/// A dynamic mesh that starts as a copy of the parent (which need not outlive it). Untouched faces and all vertices of the parent
/// keep their numbers; a face that is split keeps its number for one of its parts, the others follow at the end.
class Imprinter {
public:
    explicit Imprinter(const Surface& parent);
    ~Imprinter();
    Imprinter(Imprinter&&) noexcept;
    Imprinter& operator=(Imprinter&&) noexcept;

    /// Imprints a path on the PARENT surface; t gives each path point's parameter (same length as path.points, not descending).
    /// Returns the chain's number. A point or crossing nearer than 0.05 x the shortest incident edge to a vertex snaps to it (but
    /// not from farther than 0.02 x the curve's length; edges inside a parent face that no curve holds do not count). About
    /// linear in the number of path points and crossings. Throws Error(bad_input) when consecutive points have no common face, or
    /// when fewer than 2 vertices (closed: 3) are left.
    int imprint(const SurfacePath& path, const std::vector<double>& t);

    /// The current surface, its map to the parent, and all chains so far. May be called between imprints.
    RefinedSurface surface() const;
    CurveChain chain(int number) const;
    int chain_count() const;
    /// Whether the chain visits no vertex twice: it neither crosses nor touches itself.
    bool is_simple(int number) const;
    /// A vertex of the imprinted surface as a point on the parent surface.
    SurfacePoint parent_point(int vertex) const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Points and paths on a refined surface as points and paths on its parent.
SurfacePoint to_parent(const Surface& parent, const RefinedSurface& refined, const SurfacePoint& at);
SurfacePath to_parent(const Surface& parent, const RefinedSurface& refined, const SurfacePath& path);

}  // namespace pvg
