// Distances from imprinted curves and the curves at a distance from them: a curve is a row of point sources, close
// enough together that the offset is smooth.
#pragma once

#include <span>
#include <vector>

#include "geodesic/geodesic.h"
#include "geodesic/paths.h"
#include "mesh/surface.h"
#include "mesh/surface_map.h"

namespace pvg {

/// A halfedge that distances are measured from, with positions along the curve at its two ends.
struct SourceEdge {
    int halfedge = none;
    double at_origin = 0;
    double at_target = 0;
    int label = 0;
};

/// Sources at the ends of the edges, each vertex once (the first edge's position and label win), and between them at most
/// `spacing` apart. A point at distance w from the curve is at most spacing^2 / (8 w) farther from the nearest source.
struct CurveSources {
    std::vector<GeodesicSource> sources;
    std::vector<double> position;  ///< per source
    std::vector<int> label;        ///< per source
    std::vector<int> vertex;       ///< per source: the vertex, or none between vertices
};
CurveSources sources_along(const Surface& surface, std::span<const SourceEdge> edges, double spacing);

/// A larger lower bound of the largest distance than the vertices give: exact distances on a grid in every face that may hold
/// it. Needs field.windows.
double largest_distance(const Surface& surface, const GeodesicField& field, std::span<const GeodesicSource> sources);

/// Without the points inside faces that the straight line misses by less than tolerance (mesh units). kept: the numbers of the
/// points that stay.
SurfacePath simplified(const Surface& surface, const SurfacePath& path, double tolerance,
                       std::vector<std::size_t>* kept = nullptr);

/// Of several sources, the one nearest to a point in space.
int nearest_of(const Surface& surface, std::span<const GeodesicSource> sources, std::span<const int> candidates, const Point& at);

}  // namespace pvg
