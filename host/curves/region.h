// Face sets bounded by imprinted curves: flood fill over faces that stops at one curve and at no other.
#pragma once

#include <span>
#include <vector>

#include "curves/imprint.h"
#include "mesh/surface.h"

namespace pvg {

/// One edge of a chain: the halfedge along the travel (its face is on the left) and the one against it (face on the right); none
/// off a border.
struct ChainEdge {
    int left = none;
    int right = none;
};

/// The edges of a chain in order of travel: edge i joins vertex i to vertex i + 1 (closed: the last joins the first).
std::vector<ChainEdge> chain_edges(const Surface& surface, const CurveChain& chain);

/// Without the places where snapping makes a chain go to a vertex and straight back (A, B, A becomes A).
CurveChain without_spikes(CurveChain chain);

/// Sets the flags of a chain's halfedges, both of each edge. flags: one a halfedge.
void mark_chain(const Surface& surface, const CurveChain& chain, std::vector<char>& flags);

/// One flag a face: 1 for those reached from the seeds without crossing a flagged halfedge.
std::vector<char> flood_faces(const Surface& surface, std::span<const char> barrier, std::span<const int> seeds);

/// The faces inside a closed chain: the smaller side by area, on a tie (to 1e-9 of the sum) the left one; where the chain runs
/// along a border and has one side only, that side. Throws Error(bad_input), the place in words, when the chain crosses or
/// touches itself or does not separate the surface.
std::vector<char> faces_inside(const Surface& surface, const CurveChain& chain);

}  // namespace pvg
