// What several geodesic tests measure on paths.
#pragma once

#include <ctime>
#include <span>
#include <vector>

#include "geodesic/paths.h"
#include "mesh/surface.h"

namespace pvg::checks {

inline GeodesicField field_of(const Surface& surface, const std::vector<GeodesicSource>& sources) {
    GeodesicOptions options;
    options.keep_windows = true;
    return geodesic_distances(surface, sources, options);
}

/// Sum of the straight pieces, in space.
inline double path_length(const Surface& surface, const SurfacePath& path) {
    double sum = 0;
    for (std::size_t i = 0; i + 1 < path.points.size() + path.closed; ++i)
        sum += (surface.position(path.points[i]) - surface.position(path.points[(i + 1) % path.points.size()])).norm();
    return sum;
}

inline bool in_closed_face(const Surface& surface, const SurfacePoint& at, int face) {
    if (at.face == face)
        return true;
    for (int k = 0; k < 3; ++k) {
        if (at.bary[k] == 0)
            continue;
        const Face& corners = surface.face(face);
        const int v = surface.face(at.face)[k];
        if (corners[0] != v && corners[1] != v && corners[2] != v)
            return false;
    }
    return true;
}

/// How many pieces of the path do not lie in one common face.
inline int broken_pieces(const Surface& surface, const SurfacePath& path) {
    int broken = 0;
    for (std::size_t i = 0; i + 1 < path.points.size() + path.closed; ++i) {
        const SurfacePoint &a = path.points[i], &b = path.points[(i + 1) % path.points.size()];
        bool common = in_closed_face(surface, a, b.face) || in_closed_face(surface, b, a.face);
        for (int k = 0; k < 3 && !common; ++k) {
            const int first = surface.outgoing(surface.face(a.face)[k]);
            int h = first;
            do {
                common = common || (in_closed_face(surface, a, h / 3) && in_closed_face(surface, b, h / 3));
                h = surface.twin(Surface::prev(h));
            } while (h != none && h != first);
        }
        broken += !common;
    }
    return broken;
}

inline double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace pvg::checks
