// Procedural meshes: what `pvg make` writes and what tests and demo scenes stand on.
#pragma once

#include <string>
#include <vector>

#include "mesh/surface.h"

namespace pvg {

/// A triangle soup with normals and texture coordinates (sizes equal), ready to be written or welded.
struct ShapeMesh {
    std::vector<Point> points;
    std::vector<Point> normals;
    std::vector<Eigen::Vector2d> texcoords;
    std::vector<Face> faces;
};

/// shape: cuboid, sphere, plane, torus, vase, stele. vertices: about how many welded vertices (>= 8). Throws Error(usage) for an
/// unknown shape.
ShapeMesh make_shape(const std::string& shape, int vertices);
/// The names above.
const std::vector<std::string>& shape_names();

}  // namespace pvg
