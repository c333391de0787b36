// Which corners of the output surface share a shading normal.
#pragma once

#include <span>
#include <vector>

#include "curves/arrangement.h"
#include "mesh/surface.h"
#include "mesh/surface_map.h"

namespace pvg {

/// The input's normal at every corner of the output (3F), interpolated on raw faces; empty when the input has none.
std::vector<Point> corner_input_normals(const Arrangement& arrangement, const SurfaceMap& map,
                                        std::span<const int> welded_face_raw, std::span<const Face> raw_faces,
                                        std::span<const Face> raw_to_welded, std::span<const Point> raw_normals);

/// Groups the corners around each vertex: neighbours across an edge share a normal unless a height may jump across it or the
/// input has a crease there (different normals on its two sides; without normals: an angle of more than 40 degrees). Returns per
/// corner (3F) the group, numbered from 0 in order of first corner.
std::vector<int> shading_groups(const Arrangement& arrangement, std::span<const Point> input_normals, int* count);

}  // namespace pvg
