// A level set of the exact distance as circular arcs: in the unfolded face it is the border of a union of disks around the
// (pseudo-)sources.
#pragma once

#include <span>
#include <vector>

#include "geodesic/geodesic.h"
#include "geodesic/paths.h"

namespace pvg {

/// Where an arc starts or ends: at a vertex, on an edge (halfedge of its own face and place along it), or inside the face.
struct ArcEnd {
    int vertex = none;
    int halfedge = none;
    double t = 0;
};

/// Counter-clockwise around `center` from angle `from` to `to` (from < to), in the frame of its face's first halfedge.
struct LevelArc {
    int face = none;
    Eigen::Vector2d center{0, 0};
    double radius = 0;
    double from = 0, to = 0;
    ArcEnd start, end;
    int root = none;
    bool straight = false;  ///< directions at the source are rotation + angle; else rotation
    double rotation = 0;
};

/// Arcs in the order of travel, the sources on the left.
struct LevelLoop {
    std::vector<LevelArc> arcs;
    bool closed = false;
};

std::vector<LevelLoop> level_loops(const Surface& surface, const GeodesicField& field, std::span<const GeodesicSource> sources,
                                   double distance);

/// Points from the loop's first arc's start; a chord is off by at most `tolerance`.
SurfacePath sampled(const Surface& surface, const LevelLoop& loop, double tolerance);

/// The point of an arc at an angle.
SurfacePoint point_on(const Surface& surface, const LevelArc& arc, double angle);

}  // namespace pvg
