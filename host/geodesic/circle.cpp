// Level sets and geodesic circles as paths.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "geodesic/face_cones.h"
#include "geodesic/level_arcs.h"
#include "geodesic/metric.h"
#include "geodesic/paths.h"
#include "pvg/status.h"

namespace pvg {
namespace {

constexpr double pi = std::numbers::pi;

/// Angle of the edge of an arc's end in the frame of its face's first halfedge.
double edge_angle(const Surface& surface, const LevelArc& arc, int halfedge) {
    double turn = 0;
    for (int h = 3 * arc.face; h != halfedge; ++h) {
        const HalfedgeFrame frame = halfedge_frame(surface, h + 1);
        turn += pi - std::atan2(frame.apex_y, frame.apex_x);
    }
    return turn;
}

/// Is the part within the loop a disk? Gauss and Bonnet: its curvature and the loop's turning make 2 pi times the Euler
/// characteristic.
bool bounds_disk(const Surface& surface, const GeodesicField& field, const LevelLoop& loop, double radius) {
    double sum = 0;
    for (int v = 0; v < surface.vertex_count(); ++v)
        if (field.distance[v] < radius) {
            if (surface.is_border_vertex(v))
                return false;
            sum += 2 * pi - surface.angle_sum(v);
        }
    for (std::size_t i = 0; i < loop.arcs.size(); ++i) {
        const LevelArc& a = loop.arcs[i];
        const LevelArc& b = loop.arcs[(i + 1) % loop.arcs.size()];
        sum += a.to - a.from;
        if (a.to - a.from >= 2 * pi ||
            (a.face != b.face && (a.end.halfedge == none || surface.twin(a.end.halfedge) != b.start.halfedge)))
            continue;
        double kink = b.from - a.to;
        if (a.face != b.face)
            kink += edge_angle(surface, a, a.end.halfedge) - edge_angle(surface, b, b.start.halfedge) + pi;
        sum += std::remainder(kink, 2 * pi);
    }
    return std::lround(sum / (2 * pi)) == 1;
}

struct Attempt {
    GeodesicField field;
    std::vector<LevelLoop> loops;
    bool fits = false;
};

Attempt try_radius(const Surface& surface, const GeodesicSource& center, double radius) {
    Attempt attempt;
    GeodesicOptions options;
    options.keep_windows = true;
    options.max_distance = radius * (1 + 1e-9);
    options.keep_beyond = radius;
    attempt.field = geodesic_distances(surface, std::span(&center, 1), options);
    attempt.loops = level_loops(surface, attempt.field, std::span(&center, 1), radius);
    attempt.fits =
        attempt.loops.size() == 1 && attempt.loops[0].closed && bounds_disk(surface, attempt.field, attempt.loops[0], radius);
    return attempt;
}

/// Direction at the center of the shortest path to a point, and the range of such directions.
double direction_towards(const Surface& surface, const GeodesicSource& center, const SurfacePoint& at) {
    GeodesicOptions options;
    options.keep_windows = true;
    options.targets = {at};
    options.max_distance = length(surface, straightened_path(surface, center.at, at)) * (1 + 1e-9);
    options.toward = surface.position(at);
    const GeodesicField field = geodesic_distances(surface, std::span(&center, 1), options);
    const int v = place_of(surface, at).vertex;
    if (v != none) {
        if (field.root[v] == none)
            throw Error(ErrorKind::bad_input, "circle: its start lies on another component than its center");
        if (field.is_source[v])
            throw Error(ErrorKind::bad_input, "circle: its start must not be its center");
        return field.direction[v];
    }
    FaceCones cones(surface, field, std::span(&center, 1));
    const std::vector<Cone>& all = cones.at(at.face);
    const auto& q = cones.corners();
    const Eigen::Vector2d p = at.bary[0] * q[0] + at.bary[1] * q[1] + at.bary[2] * q[2];
    const int best = cones.nearest(at.face, p);
    if (best == none)
        throw Error(ErrorKind::bad_input, "circle: its start lies on another component than its center");
    const Eigen::Vector2d d = p - all[best].center;
    if (d.norm() <= 1e-12 * surface.diagonal())
        throw Error(ErrorKind::bad_input, "circle: its start must not be its center");
    return all[best].rotation + (all[best].straight ? std::atan2(d.y(), d.x()) : 0);
}

/// Splits the loop so that it begins at the direction, or as near to it as it gets.
void begin_at(LevelLoop& loop, double direction, double turn) {
    std::size_t best = 0;
    double nearest = std::numeric_limits<double>::infinity(), place = 0;
    for (std::size_t i = 0; i < loop.arcs.size(); ++i) {
        const LevelArc& arc = loop.arcs[i];
        double at = arc.from, off = std::abs(std::remainder(arc.rotation - direction, turn));
        if (arc.straight) {
            double ahead = std::fmod(direction - (arc.rotation + arc.from), turn);
            if (ahead < 0)
                ahead += turn;
            const double width = arc.to - arc.from;
            at = ahead <= width ? arc.from + ahead : ahead - width < turn - ahead ? arc.to : arc.from;
            off = ahead <= width ? 0 : std::min(ahead - width, turn - ahead);
        }
        if (off >= nearest)
            continue;
        nearest = off;
        best = i;
        place = at;
    }
    std::rotate(loop.arcs.begin(), loop.arcs.begin() + static_cast<std::ptrdiff_t>(best), loop.arcs.end());
    LevelArc& first = loop.arcs.front();
    if (place == first.from)
        return;
    if (first.to - first.from >= 2 * pi) {  // a whole circle only turns
        first.from = place;
        first.to = place + 2 * pi;
        return;
    }
    if (place == first.to) {
        std::rotate(loop.arcs.begin(), loop.arcs.begin() + 1, loop.arcs.end());
        return;
    }
    LevelArc head = first;
    first.from = head.to = place;
    first.start = head.end = {};
    loop.arcs.push_back(head);
}

}  // namespace

std::vector<SurfacePath> level_set(const Surface& surface, const GeodesicField& field, std::span<const GeodesicSource> sources,
                                   double distance, double tolerance) {
    if (!(tolerance > 0))
        throw Error(ErrorKind::bad_input, "level set: the tolerance must be positive");
    std::vector<SurfacePath> paths;
    for (const LevelLoop& loop : level_loops(surface, field, sources, distance))
        paths.push_back(sampled(surface, loop, tolerance));
    return paths;
}

SurfacePath geodesic_circle(const Surface& surface, const SurfacePoint& center, double radius, const SurfacePoint& start,
                            double tolerance) {
    check_point(surface, center, "circle: center");
    check_point(surface, start, "circle: start");
    if (!(radius > 0) || !std::isfinite(radius))
        throw Error(ErrorKind::bad_input, "circle: the radius must be positive");
    if (!(tolerance > 0))
        throw Error(ErrorKind::bad_input, "circle: the tolerance must be positive");
    const GeodesicSource source{center, 0};
    const int at = place_of(surface, center).vertex;
    Attempt attempt = try_radius(surface, source, radius);
    if (!attempt.fits) {
        double low = 0, high = radius;
        for (int step = 0; step < 24; ++step) {
            const double middle = (low + high) / 2;
            (try_radius(surface, source, middle).fits ? low : high) = middle;
        }
        const Point p = surface.position(center);
        throw Error(ErrorKind::bad_input, "circle around (" + std::to_string(p.x()) + ", " + std::to_string(p.y()) + ", " +
                                              std::to_string(p.z()) + ") with radius " + std::to_string(radius) +
                                              " is not one closed loop around a disk; the largest radius that is one is about " +
                                              std::to_string(low));
    }
    LevelLoop& loop = attempt.loops[0];
    begin_at(loop, direction_towards(surface, source, start), at == none ? 2 * pi : surface.angle_sum(at));
    return sampled(surface, loop, tolerance);
}

}  // namespace pvg
