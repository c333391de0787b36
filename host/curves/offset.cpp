#include "curves/offset.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pvg {
namespace {

SurfacePoint point_on_halfedge(int h, double fraction) {
    SurfacePoint at{h / 3, Eigen::Vector3d::Zero()};
    at.bary[h % 3] = 1 - fraction;
    at.bary[(h + 1) % 3] = fraction;
    return at;
}

double distance_to_segment(const Point& p, const Point& a, const Point& b) {
    const Point along = b - a;
    const double square = along.squaredNorm();
    const double s = square > 0 ? std::clamp((p - a).dot(along) / square, 0.0, 1.0) : 0.0;
    return (p - a - s * along).norm();
}

/// Whether the point lies on the (closed) face, whichever face it is written in.
bool lies_on(const Surface& surface, const SurfacePoint& at, int face) {
    if (at.face == face)
        return true;
    const Face& corners = surface.face(face);
    for (int k = 0; k < 3; ++k)
        if (at.bary[k] > 1e-9 && std::find(corners.begin(), corners.end(), surface.face(at.face)[k]) == corners.end())
            return false;
    return true;
}

bool inside_face(const SurfacePoint& at) { return at.bary.minCoeff() > 1e-9; }

}  // namespace

CurveSources sources_along(const Surface& surface, std::span<const SourceEdge> edges, double spacing) {
    CurveSources result;
    std::vector<char> seen(surface.vertex_count(), 0);
    const auto add = [&](const SurfacePoint& at, double position, int label, int vertex) {
        result.sources.push_back({at, 0});
        result.position.push_back(position);
        result.label.push_back(label);
        result.vertex.push_back(vertex);
    };
    for (const SourceEdge& edge : edges) {
        const int from = surface.origin(edge.halfedge), to = surface.target(edge.halfedge);
        if (!seen[from])
            add(at_vertex(surface, from), edge.at_origin, edge.label, from);
        if (!seen[to])
            add(at_vertex(surface, to), edge.at_target, edge.label, to);
        seen[from] = seen[to] = 1;
        const int pieces = static_cast<int>(std::min(1e4, std::ceil(surface.length(edge.halfedge) / spacing)));
        for (int i = 1; i < pieces; ++i) {
            const double s = static_cast<double>(i) / pieces;
            add(point_on_halfedge(edge.halfedge, s), edge.at_origin + s * (edge.at_target - edge.at_origin), edge.label, none);
        }
    }
    return result;
}

double largest_distance(const Surface& surface, const GeodesicField& field, std::span<const GeodesicSource> sources) {
    double most = 0;
    for (double d : field.distance)
        if (std::isfinite(d))
            most = std::max(most, d);
    constexpr int grid = 8;
    for (int f = 0; f < surface.face_count(); ++f) {
        // No point of the face is farther than a corner and the longest edge.
        double nearest = std::numeric_limits<double>::infinity(), longest = 0;
        for (int k = 0; k < 3; ++k) {
            nearest = std::min(nearest, field.distance[surface.face(f)[k]]);
            longest = std::max(longest, surface.length(3 * f + k));
        }
        if (!(nearest + longest > most))
            continue;
        for (int i = 0; i <= grid; ++i)
            for (int j = 0; i + j <= grid; ++j) {
                const SurfacePoint at{f, Eigen::Vector3d(grid - i - j, i, j) / grid};
                const double d = distance_at(surface, field, sources, at);
                if (std::isfinite(d))
                    most = std::max(most, d);
            }
    }
    return most;
}

SurfacePath simplified(const Surface& surface, const SurfacePath& path, double tolerance, std::vector<std::size_t>* kept) {
    std::vector<std::size_t> stay;
    const std::size_t count = path.points.size();
    for (std::size_t i = 0; i < count; ++i) {
        const bool end = !path.closed && i + 1 == count;
        bool needed = i == 0 || end || !inside_face(path.points[i]);
        if (!needed) {
            // The next point must lie in this face as well, and the chord to it pass all points left out near enough.
            const SurfacePoint& after = path.points[(i + 1) % count];
            const SurfacePoint& before = path.points[stay.back()];
            needed = !lies_on(surface, after, path.points[i].face) || !lies_on(surface, before, path.points[i].face);
            for (std::size_t j = stay.back() + 1; j <= i && !needed; ++j)
                needed = distance_to_segment(surface.position(path.points[j]), surface.position(before),
                                             surface.position(after)) > tolerance;
        }
        if (needed)
            stay.push_back(i);
    }
    if (stay.size() < (path.closed ? 3u : 2u)) {
        stay.resize(count);
        for (std::size_t i = 0; i < count; ++i) stay[i] = i;
    }
    SurfacePath result{{}, path.closed};
    for (std::size_t i : stay) result.points.push_back(path.points[i]);
    if (kept)
        *kept = std::move(stay);
    return result;
}

int nearest_of(const Surface& surface, std::span<const GeodesicSource> sources, std::span<const int> candidates,
               const Point& at) {
    int best = none;
    double least = std::numeric_limits<double>::infinity();
    for (int candidate : candidates) {
        if (candidate == none)
            continue;
        const double d = (surface.position(sources[candidate].at) - at).norm();
        if (d < least || (d == least && candidate < best)) {
            least = d;
            best = candidate;
        }
    }
    return best;
}

}  // namespace pvg
