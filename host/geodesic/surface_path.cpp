// What every polyline on a surface can be asked: its length, the point at a fraction of it, the face of a piece.
#include <algorithm>
#include <array>
#include <string>

#include "geodesic/metric.h"
#include "geodesic/paths.h"
#include "pvg/status.h"

namespace pvg {
namespace {

constexpr double zero = 1e-12;

struct Corners {
    std::array<int, 3> vertex{none, none, none};
    int count = 0;
};

Corners corners_of(const Surface& surface, const SurfacePoint& at) {
    Corners used;
    for (int k = 0; k < 3; ++k)
        if (at.bary[k] > zero)
            used.vertex[used.count++] = surface.face(at.face)[k];
    return used;
}

bool has(const Face& face, const Corners& corners) {
    return std::all_of(corners.vertex.begin(), corners.vertex.begin() + corners.count,
                       [&](int v) { return v == face[0] || v == face[1] || v == face[2]; });
}

}  // namespace

int common_face(const Surface& surface, const SurfacePoint& a, const SurfacePoint& b) {
    if (a.face == b.face)
        return a.face;
    const Corners of_a = corners_of(surface, a), of_b = corners_of(surface, b);
    if (has(surface.face(a.face), of_b))
        return a.face;
    if (has(surface.face(b.face), of_a))
        return b.face;
    if (of_a.count == 3 || of_b.count == 3)
        return none;  // inside their own faces
    const int first = surface.outgoing(of_a.vertex[0]);
    int h = first;
    while (h != none) {
        if (has(surface.face(h / 3), of_a) && has(surface.face(h / 3), of_b))
            return h / 3;
        h = surface.twin(Surface::prev(h));
        if (h == first)
            break;
    }
    return none;
}

Eigen::Vector3d bary_in(const Surface& surface, int face, const SurfacePoint& at) {
    if (at.face == face)
        return at.bary;
    Eigen::Vector3d bary(0, 0, 0);
    for (int k = 0; k < 3; ++k)
        for (int j = 0; j < 3; ++j)
            if (surface.face(face)[j] == surface.face(at.face)[k] && at.bary[k] > zero)
                bary[j] = at.bary[k];
    return bary;
}

double length(const Surface& surface, const SurfacePath& path) {
    double sum = 0;
    for (std::size_t i = 1; i < path.points.size(); ++i)
        sum += (surface.position(path.points[i]) - surface.position(path.points[i - 1])).norm();
    if (path.closed && path.points.size() > 1)
        sum += (surface.position(path.points.front()) - surface.position(path.points.back())).norm();
    return sum;
}

SurfacePoint point_along(const Surface& surface, const SurfacePath& path, double s) {
    if (path.points.empty())
        throw Error(ErrorKind::bad_input, "path: a path without points has no point at " + std::to_string(s));
    const std::size_t count = path.points.size();
    if (s <= 0 || count == 1)
        return path.points.front();
    if (s >= 1)
        return path.closed ? path.points.front() : path.points.back();
    const double wanted = s * length(surface, path);
    double before = 0;
    const std::size_t pieces = path.closed ? count : count - 1;
    for (std::size_t i = 0; i < pieces; ++i) {
        const SurfacePoint &a = path.points[i], &b = path.points[(i + 1) % count];
        const double piece = (surface.position(b) - surface.position(a)).norm();
        if (before + piece < wanted || piece == 0) {
            before += piece;
            continue;
        }
        const double share = std::clamp((wanted - before) / piece, 0.0, 1.0);
        const int face = common_face(surface, a, b);
        if (face == none)
            throw Error(ErrorKind::bad_input,
                        "path: points " + std::to_string(i) + " and " + std::to_string((i + 1) % count) + " have no common face");
        const Eigen::Vector3d bary = (1 - share) * bary_in(surface, face, a) + share * bary_in(surface, face, b);
        return {face, bary / bary.sum()};
    }
    return path.closed ? path.points.front() : path.points.back();
}

}  // namespace pvg
