// A scene's primitives drawn on the surface: each path traced, imprinted and known as a chain of edges, each source as
// numbers on faces. Nothing is slit yet.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "curves/arrangement.h"
#include "curves/imprint.h"
#include "mesh/surface_map.h"
#include "scene/scene.h"

namespace pvg {

/// A primitive's Laplacian for the value 1, per mesh unit^2 as (face of the imprinted surface, value), ascending: of a Poisson
/// region, or of a wide Poisson curve whose jump is 1 at one of its stops and falls to 0 at that stop's neighbours.
struct DrawnSource {
    std::vector<std::pair<int, double>> profile;
    std::vector<double> stops;  ///< all stops of the curve's jump; empty: a region
    std::size_t stop = 0;
};

struct DrawnPrimitive {
    const Primitive* primitive = nullptr;
    int layer = none;
    std::string where;  ///< "FILE: POINTER", for messages
    CurveChain chain;
    std::vector<CurveChain> borders;  ///< inner borders of a region's ring, outer borders of a Poisson curve's strips
    std::vector<DrawnSource> sources;
};

struct Drawing {
    RefinedSurface imprinted;
    std::vector<DrawnPrimitive> primitives;  ///< in the scene's order, disabled ones left out
};

/// Lengths of the scene times unit are mesh units. Throws Error(bad_input) "FILE: POINTER: ...".
Drawing draw(const Scene& scene, const BaseSurface& base, double unit);

/// The second half of arrange(): groups, slits and domains of what is drawn. base: the surface whose edges give
/// Domain::edge_length.
Arrangement arrange_drawing(const Scene& scene, const Surface& base, Drawing drawing, Warnings& warnings);

}  // namespace pvg
