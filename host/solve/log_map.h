// A log map good enough to span low harmonic polynomials: the surface around a vertex laid into the plane face by face, nearest
// vertices first. Exact in the plane; elsewhere distances from the vertex come from faces in their true size, and directions are
// interpolated between a face's corners. Faces are those of the intrinsic Delaunay triangulation: long triangles would leave a
// patch and tear it apart. After R. Schmidt, C. Grimm, B. Wyvill, "Interactive decal compositing with discrete exponential
// maps", ACM TOG 25(3), 2006, and E. L. Melvaer, M. Reimers, "Geodesic polar coordinates on polygonal meshes", Computer
// Graphics Forum 31(8), 2012.
#pragma once

#include <complex>
#include <utility>
#include <vector>

#include "mesh/intrinsic.h"

namespace pvg {

/// The faces' shapes, made once; const calls may run in parallel.
class LogMap {
public:
    /// partner: per vertex the next copy on sharp Poisson curves, in a ring, or none; copies fall together.
    LogMap(const Surface& surface, const std::vector<int>& partner);

    /// Working memory of one thread.
    struct Buffers {
        std::vector<std::complex<double>> sum;
        std::vector<double> reach;  ///< sum of the distances that the votes give
        std::vector<int> votes;
        std::vector<char> laid;
        std::vector<std::pair<double, int>> queue;
    };

    /// Lays out the vertices of a patch around the first of them. local: vertex of the surface -> number in the patch, or none.
    /// Vertices that no face connects to the rest take a neighbour's place. place: one point per number in the patch.
    void unfold(const std::vector<int>& vertices, const std::vector<int>& local, Buffers& buffers,
                std::vector<std::complex<double>>& place) const;

private:
    /// What the layout asks of a corner between two edges that leave a vertex. A vertex's corners stand together, in
    /// counter-clockwise order, since memory is what a map waits for.
    struct Corner {
        int target = none;              ///< where the first edge goes
        int third = none;               ///< where the second one goes
        double length = 0;              ///< of the first
        double turn_x = 0, turn_y = 0;  ///< second = turn x first, in the face's plane; 0 without length
    };

    const std::vector<int>& partner_;
    std::vector<int> corner_first_;  ///< per vertex + 1
    std::vector<Corner> corners_;
    std::vector<char> closed_;  ///< per vertex: corners go all around it
};

}  // namespace pvg
