// Distances and paths inside faces, read back from the windows of an exact field: the face strip of a path is unfolded along the
// straight line to its (pseudo-)source, as in Xin and Wang (2009), section 3.5.
#include "geodesic/paths.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "geodesic/face_cones.h"
#include "geodesic/metric.h"
#include "pvg/status.h"

namespace pvg {
namespace {

using Vec2 = Eigen::Vector2d;

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

SurfacePoint on_halfedge(int h, double t) {
    SurfacePoint point;
    point.face = h / 3;
    point.bary.setZero();
    point.bary[h % 3] = 1 - t;
    point.bary[(h + 1) % 3] = t;
    return point;
}

/// Walks back from a surface point to its source, piece by straight piece.
class WayBack {
public:
    WayBack(const Surface& surface, const GeodesicField& field, std::span<const GeodesicSource> sources)
        : surface_(surface), field_(field), sources_(sources), cones_(surface, field, sources) {}

    SurfacePath from(const SurfacePoint& at) {
        check_point(surface_, at, "path_to_source");
        path_.points.assign(1, at);
        // A line that rounding made miss its aim is taken up anew from where it got lost; each time it is nearer.
        for (int piece = 0; piece < 10 * surface_.vertex_count() + 100; ++piece) {
            const SurfacePoint here = path_.points.back();
            const int v = place_of(surface_, here).vertex;
            if (v != none ? from_vertex(v) : from_inside(here))
                return std::move(path_);
        }
        throw Error(ErrorKind::bad_input, "the path back to the source from face " + std::to_string(at.face) +
                                              " does not end: the field must belong to this surface and these sources");
    }

private:
    [[noreturn]] void unreached(const std::string& where) const {
        throw Error(ErrorKind::bad_input,
                    "no source reaches " + where + ": it lies on another component or beyond the field's max_distance");
    }

    bool from_vertex(int v) {
        if (field_.root[v] == none)
            unreached("vertex " + std::to_string(v));
        if (field_.is_source[v])
            return true;
        const int goal = field_.via[v], root = field_.root[v];
        const double base = goal == none ? sources_[root].distance : field_.distance[goal];
        const double angle = field_.arrival[v];
        // The face of the fan that the path runs in.
        int h = surface_.outgoing(v);
        const int first = h;
        double low = 0;
        while (true) {
            const HalfedgeFrame frame = halfedge_frame(surface_, h);
            const double corner = std::atan2(frame.apex_y, frame.apex_x);
            const int following = surface_.twin(Surface::prev(h));
            if (angle <= low + corner || following == none || following == first) {
                if (finish_in(h / 3, goal, root))
                    return goal == none;
                const double turn = std::clamp(angle - low, 0.0, corner), length = field_.distance[v] - base;
                const Vec2 apex(frame.apex_x, frame.apex_y), center(length * std::cos(turn), length * std::sin(turn));
                return trace(Surface::next(h), Vec2(0, 0), center, Vec2(frame.length, 0), apex, goal, root);
            }
            low += corner;
            h = following;
        }
    }

    bool from_inside(const SurfacePoint& at) {
        const std::vector<Cone>& cones = cones_.at(at.face);
        const auto& q = cones_.corners();
        const Vec2 p = at.bary[0] * q[0] + at.bary[1] * q[1] + at.bary[2] * q[2];
        const int best = cones_.nearest(at.face, p);
        if (best == none)
            unreached("face " + std::to_string(at.face));
        const Cone& cone = cones[best];
        const int goal = cone.straight ? none : cone.vertex;
        if (cone.halfedge == none || contains(at.face, goal, cone.root)) {
            finish_in(at.face, goal, cone.root);
            return goal == none;
        }
        const int k = cone.halfedge % 3;
        return trace(cone.halfedge, p, cone.center, q[k], q[(k + 1) % 3], goal, cone.root);
    }

    /// Is the end of this straight piece in the (closed) face? goal: a pseudo-source, or none for the source.
    bool contains(int face, int goal, int root) const {
        Place place;
        if (goal != none) {
            place.vertex = goal;
        } else {
            place = place_of(surface_, sources_[root].at);
            if (place.vertex == none) {
                if (sources_[root].at.face == face)
                    return true;
                const int twin = place.halfedge == none ? none : surface_.twin(place.halfedge);
                return twin != none && twin / 3 == face;
            }
        }
        const Face& corners = surface_.face(face);
        return std::find(corners.begin(), corners.end(), place.vertex) != corners.end();
    }

    /// If so, goes there: inside a face nothing is shorter.
    bool finish_in(int face, int goal, int root) {
        if (!contains(face, goal, root))
            return false;
        path_.points.push_back(goal == none ? sources_[root].at : corner_point(face, goal));
        return true;
    }

    SurfacePoint corner_point(int face, int v) const {
        SurfacePoint point;
        point.face = face;
        for (int k = 0; k < 3; ++k) point.bary[k] = surface_.face(face)[k] == v ? 1 : 0;
        return point;
    }

    /// Along the line from p to center, out through halfedge h with its ends at a and b. True when the source is reached.
    bool trace(int h, const Vec2& p, const Vec2& center, Vec2 a, Vec2 b, int goal, int root) {
        const Vec2 line = center - p;
        const double reach = line.norm() * (1 + 1e-6);
        while (true) {
            const double of_a = cross(line, a - p), of_b = cross(line, b - p);
            const double t = of_b > of_a ? std::clamp(of_a / (of_a - of_b), 0.0, 1.0) : 0.5;
            // Through a vertex: its own way back goes on, rather than this line on the side that rounding picks. Wrong by the
            // square only.
            if (t < 1e-9 || t > 1 - 1e-9) {
                const SurfacePoint corner = on_halfedge(h, t < 0.5 ? 0 : 1);
                if (place_of(surface_, corner).vertex != place_of(surface_, path_.points.back()).vertex)
                    path_.points.push_back(corner);
                return false;
            }
            path_.points.push_back(on_halfedge(h, t));
            const int g = surface_.twin(h);
            if (g == none || ((1 - t) * a + t * b - p).norm() > reach)
                return false;
            path_.points.back() = on_halfedge(g, 1 - t);  // the face to go on in
            if (finish_in(g / 3, goal, root))
                return goal == none;
            const HalfedgeFrame frame = halfedge_frame(surface_, g);
            const Vec2 axis = (a - b) * frame.inverse;
            const Vec2 apex = b + frame.apex_x * axis + frame.apex_y * Vec2(-axis.y(), axis.x());
            // A line that grazes the border through a vertex must not leave the surface.
            bool right = cross(line, apex - p) >= 0;
            const int next = Surface::next(g), prev = Surface::prev(g);
            if (surface_.twin(right ? next : prev) == none && surface_.twin(right ? prev : next) != none)
                right = !right;
            if (right) {
                h = next;
                b = apex;
            } else {
                h = prev;
                a = apex;
            }
        }
    }

    const Surface& surface_;
    const GeodesicField& field_;
    std::span<const GeodesicSource> sources_;
    FaceCones cones_;
    SurfacePath path_;
};

}  // namespace

double distance_at(const Surface& surface, const GeodesicField& field, std::span<const GeodesicSource> sources,
                   const SurfacePoint& at) {
    check_point(surface, at, "distance_at");
    const int v = place_of(surface, at).vertex;
    if (v != none)
        return field.distance[v];
    FaceCones cones(surface, field, sources);
    cones.at(at.face);
    const auto& q = cones.corners();
    double distance = 0;
    cones.nearest(at.face, at.bary[0] * q[0] + at.bary[1] * q[1] + at.bary[2] * q[2], &distance);
    return distance;
}

SurfacePath path_to_source(const Surface& surface, const GeodesicField& field, std::span<const GeodesicSource> sources,
                           const SurfacePoint& at) {
    return WayBack(surface, field, sources).from(at);
}

SurfacePath shortest_path(const Surface& surface, const SurfacePoint& from, const SurfacePoint& to, double upper_bound) {
    check_point(surface, from, "shortest_path: from");
    check_point(surface, to, "shortest_path: to");
    const GeodesicSource source{to, 0};
    GeodesicOptions options;
    options.keep_windows = true;
    options.targets = {from};
    if (std::isfinite(upper_bound)) {
        options.max_distance = upper_bound * (1 + 1e-9);
        options.toward = surface.position(from);
    }
    const GeodesicField field = geodesic_distances(surface, std::span(&source, 1), options);
    if (!std::isfinite(distance_at(surface, field, std::span(&source, 1), from)))
        throw Error(ErrorKind::bad_input, "shortest_path: face " + std::to_string(from.face) + " and face " +
                                              std::to_string(to.face) + " are on different components of the surface");
    SurfacePath path = path_to_source(surface, field, std::span(&source, 1), from);
    return path;
}

}  // namespace pvg
