// Welding: raw vertices that share a position become one, so that split normals and texture seams do not cut the surface.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "mesh/surface.h"
#include "pvg/status.h"

namespace pvg {

struct WeldedMesh {
    Surface surface;
    std::vector<int> face_raw;        ///< per face of the surface: raw face (corner order kept), ascending
    std::vector<Face> raw_to_welded;  ///< per raw face: the welded vertex of each corner; {none, none, none} for a face left out
    std::vector<std::array<Point, 2>>
        non_manifold_edges;  ///< where more than two faces meet, or two with the same orientation: cut there
};

/// Exact position equality (-0 equals +0). Faces with a repeated welded vertex or no area are left out (a warning counts them).
/// At edges with more than two faces, or two equally oriented ones, and at vertices with several fans the surface is cut, so the
/// result is manifold.
WeldedMesh weld(std::span<const Point> points, std::span<const Face> faces, Warnings& warnings);

}  // namespace pvg
