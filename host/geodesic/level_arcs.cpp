#include "geodesic/level_arcs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "geodesic/face_cones.h"
#include "geodesic/metric.h"
#include "pvg/status.h"

namespace pvg {
namespace {

using Vec2 = Eigen::Vector2d;
constexpr double full_turn = 2 * std::numbers::pi;

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

double distance_to_segment(const Vec2& p, const Vec2& a, const Vec2& b) {
    const Vec2 d = b - a;
    const double size = d.squaredNorm(), t = size > 0 ? std::clamp((p - a).dot(d) / size, 0.0, 1.0) : 0;
    return (a + t * d - p).norm();
}

/// All arcs of one face.
class FaceArcs {
public:
    FaceArcs(const Surface& surface, const GeodesicField& field, std::span<const GeodesicSource> sources, double level)
        : surface_(surface), field_(field), level_(level), cones_(surface, field, sources) {}

    void add(int face, std::vector<LevelArc>& arcs) {
        if (!cones_.reached(face))
            return;
        double longest = 0;
        for (int k = 0; k < 3; ++k) longest = std::max(longest, surface_.length(3 * face + k));
        for (int v : surface_.face(face))
            if (std::isfinite(field_.distance[v]) && std::abs(field_.distance[v] - level_) > longest * (1 + 1e-9))
                return;
        const std::vector<Cone>& all = cones_.at(face);
        q_ = cones_.corners();
        scale_ = longest;
        near_.clear();
        for (const Cone& cone : all) {
            const double r = level_ - cone.offset;
            if (r > 0 && (inside(cone.center, 0) || std::min({distance_to_segment(cone.center, q_[0], q_[1]),
                                                              distance_to_segment(cone.center, q_[1], q_[2]),
                                                              distance_to_segment(cone.center, q_[2], q_[0])}) <= r))
                near_.push_back(cone);
        }
        for (std::size_t k = 0; k < near_.size(); ++k) add_circle(face, k, arcs);
    }

private:
    bool inside(const Vec2& p, double slack) const {
        for (int k = 0; k < 3; ++k) {
            const Vec2 d = q_[(k + 1) % 3] - q_[k];
            if (cross(d, p - q_[k]) < -slack * d.norm())
                return false;
        }
        return true;
    }

    void line(const Cone& cone, double r, const Vec2& a, const Vec2& d) {
        const double size = d.norm();
        if (!(size > 0))
            return;
        const Vec2 u = d / size;
        const double along = (cone.center - a).dot(u), away = cross(u, cone.center - a), square = r * r - away * away;
        if (square < 0)
            return;
        const Vec2 foot = a + along * u - cone.center;
        for (double s : {-std::sqrt(square), std::sqrt(square)}) angle(cone.center, foot + s * u);
    }

    /// An event on the circle, unless far from the face: there nothing is visible on either side of it.
    void angle(const Vec2& center, const Vec2& d) {
        if (!inside(center + d, 1e-6 * scale_))
            return;
        double a = std::atan2(d.y(), d.x());
        if (a < 0)
            a += full_turn;
        angles_.push_back(a);
    }

    /// Is the point on circle k in the face, and no other cone lower? Of equal ones the first counts.
    bool visible(std::size_t k, const Vec2& p) const {
        const double tie = 1e-12 * (level_ + scale_);
        if (!inside(p, 1e-13 * scale_) || !near_[k].covers(p, FaceCones::slack))
            return false;
        for (std::size_t j = 0; j < near_.size(); ++j) {
            if (j == k)
                continue;
            const double over = near_[j].value(p) - level_;
            if (over < (j < k ? tie : -tie) && near_[j].covers(p, FaceCones::slack))
                return false;
        }
        return true;
    }

    void add_circle(int face, std::size_t k, std::vector<LevelArc>& arcs) {
        const Cone& cone = near_[k];
        const double r = level_ - cone.offset;
        if (std::max({(q_[0] - cone.center).norm(), (q_[1] - cone.center).norm(), (q_[2] - cone.center).norm()}) < r)
            return;
        angles_.clear();
        for (int e = 0; e < 3; ++e) line(cone, r, q_[e], q_[(e + 1) % 3] - q_[e]);
        for (std::size_t j = 0; j < near_.size(); ++j) {
            const Cone& other = near_[j];
            if (other.wedge) {
                line(cone, r, other.center, other.left - other.center);
                line(cone, r, other.center, other.right - other.center);
            }
            const Vec2 d = other.center - cone.center;
            const double apart = d.norm(), s = level_ - other.offset;
            if (j == k || !(apart > 0))
                continue;
            const double along = (apart * apart + r * r - s * s) / (2 * apart), square = r * r - along * along;
            if (square < 0)
                continue;
            const Vec2 u = d / apart, up(-u.y(), u.x());
            angle(cone.center, along * u + std::sqrt(square) * up);
            angle(cone.center, along * u - std::sqrt(square) * up);
        }
        if (angles_.empty())
            angles_.push_back(0);
        std::sort(angles_.begin(), angles_.end());
        const auto at = [&](double a) -> Vec2 { return cone.center + r * Vec2(std::cos(a), std::sin(a)); };
        const std::size_t n = angles_.size();
        // Intervals between events; one wraps around.
        std::vector<char>& seen = seen_;
        seen.assign(n, 0);
        const auto stop = [&](std::size_t i) { return i + 1 < n ? angles_[i + 1] : angles_[0] + full_turn; };
        for (std::size_t i = 0; i < n; ++i) {
            const double width = stop(i) - angles_[i];
            if (width > 1e-14)
                seen[i] = visible(k, at(angles_[i] + width / 2));
            else
                seen[i] = 2;  // too thin to judge: as the one before
        }
        const auto first = std::find(seen.begin(), seen.end(), 0);
        if (first == seen.end()) {
            arcs.push_back(arc(face, cone, r, angles_[0], angles_[0] + full_turn));
            return;
        }
        const std::size_t base = first - seen.begin();
        char before = 0;
        double from = 0;
        for (std::size_t i = 1; i <= n; ++i) {
            const std::size_t at_i = (base + i) % n;
            const char now = seen[at_i] == 2 ? before : seen[at_i];
            const double a = angles_[at_i] + (base + i >= n ? full_turn : 0);
            if (now && !before)
                from = a;
            if (!now && before) {
                LevelArc piece = arc(face, cone, r, from, a);
                piece.start = end_of(face, at(from));
                piece.end = end_of(face, at(a));
                const bool point =
                    piece.start.vertex != none && piece.start.vertex == piece.end.vertex && r * (a - from) < 1e-8 * scale_;
                if (!point)
                    arcs.push_back(piece);
            }
            before = now;
        }
    }

    LevelArc arc(int face, const Cone& cone, double r, double from, double to) const {
        LevelArc piece;
        piece.face = face;
        piece.center = cone.center;
        piece.radius = r;
        piece.from = from;
        piece.to = to;
        piece.root = cone.root;
        piece.straight = cone.straight;
        piece.rotation = cone.rotation;
        return piece;
    }

    ArcEnd end_of(int face, const Vec2& p) const {
        ArcEnd end;
        const double near = 1e-9 * scale_;
        for (int k = 0; k < 3; ++k)
            if ((p - q_[k]).norm() < near)
                end.vertex = surface_.face(face)[k];
        if (end.vertex != none)
            return end;
        double best = near;
        for (int k = 0; k < 3; ++k) {
            const Vec2 d = q_[(k + 1) % 3] - q_[k];
            const double away = std::abs(cross(d, p - q_[k])) / d.norm();
            if (away >= best)
                continue;
            best = away;
            end.halfedge = 3 * face + k;
            end.t = std::clamp((p - q_[k]).dot(d) / d.squaredNorm(), 0.0, 1.0);
        }
        return end;
    }

    const Surface& surface_;
    const GeodesicField& field_;
    double level_;
    FaceCones cones_;
    std::array<Vec2, 3> q_;
    double scale_ = 0;
    std::vector<Cone> near_;
    std::vector<double> angles_;
    std::vector<char> seen_;
};

/// Joins every end to a start.
class Linker {
public:
    Linker(const Surface& surface, const std::vector<LevelArc>& arcs)
        : surface_(surface), arcs_(arcs), next_(arcs.size(), none), taken_(arcs.size(), 0) {}

    std::vector<int> link(double level) {
        // Group by face (bends), by edge (crossings), by vertex (exact hits).
        std::map<std::pair<int, int>, std::vector<std::pair<int, bool>>> groups;
        for (int i = 0; i < static_cast<int>(arcs_.size()); ++i) {
            const LevelArc& arc = arcs_[i];
            if (arc.to - arc.from >= full_turn) {
                next_[i] = i;
                taken_[i] = 1;
                continue;
            }
            groups[key(arc, arc.start)].emplace_back(i, true);
            groups[key(arc, arc.end)].emplace_back(i, false);
        }
        for (const auto& [where, ends] : groups) {
            double size = level;
            for (const auto& [arc, is_start] : ends) size = std::min(size, surface_.length(3 * arcs_[arc].face));
            join(ends, where.first == 2 ? level : 1e-6 * size);
        }
        // Where an arc got lost because it was too short, its neighbours are still close.
        std::vector<std::pair<int, bool>> open;
        for (int i = 0; i < static_cast<int>(arcs_.size()); ++i) {
            if (!taken_[i])
                open.emplace_back(i, true);
            if (next_[i] == none)
                open.emplace_back(i, false);
        }
        join(open, 1e-6 * level);
        return next_;
    }

private:
    std::pair<int, int> key(const LevelArc& arc, const ArcEnd& end) const {
        if (end.vertex != none)
            return {2, end.vertex};
        if (end.halfedge == none)
            return {0, arc.face};
        return {1, std::max(end.halfedge, surface_.twin(end.halfedge))};
    }

    Point position(int arc, bool start) const {
        const LevelArc& a = arcs_[arc];
        return surface_.position(point_on(surface_, a, start ? a.from : a.to));
    }

    void join(const std::vector<std::pair<int, bool>>& ends, double within) {
        struct Pair {
            double apart;
            int from, to;
        };
        std::vector<Pair> pairs;
        for (const auto& [i, i_start] : ends) {
            if (i_start)
                continue;
            const Point p = position(i, false);
            for (const auto& [j, j_start] : ends)
                if (j_start) {
                    const double apart = (position(j, true) - p).norm();
                    if (apart <= within)
                        pairs.push_back({apart, i, j});
                }
        }
        std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.apart < b.apart; });
        for (const Pair& pair : pairs)
            if (next_[pair.from] == none && !taken_[pair.to]) {
                next_[pair.from] = pair.to;
                taken_[pair.to] = 1;
            }
    }

    const Surface& surface_;
    const std::vector<LevelArc>& arcs_;
    std::vector<int> next_;
    std::vector<char> taken_;
};

}  // namespace

SurfacePoint point_on(const Surface& surface, const LevelArc& arc, double angle) {
    const ArcEnd* end = angle == arc.from ? &arc.start : angle == arc.to ? &arc.end : nullptr;
    if (end && end->vertex != none) {
        SurfacePoint point;
        point.face = arc.face;
        for (int k = 0; k < 3; ++k) point.bary[k] = surface.face(arc.face)[k] == end->vertex ? 1 : 0;
        return point;
    }
    if (end && end->halfedge != none) {
        SurfacePoint point;
        point.face = arc.face;
        point.bary.setZero();
        point.bary[end->halfedge % 3] = 1 - end->t;
        point.bary[(end->halfedge + 1) % 3] = end->t;
        return point;
    }
    const int h = 3 * arc.face;
    return from_frame(halfedge_frame(surface, h), h, arc.center + arc.radius * Vec2(std::cos(angle), std::sin(angle)));
}

std::vector<LevelLoop> level_loops(const Surface& surface, const GeodesicField& field, std::span<const GeodesicSource> sources,
                                   double distance) {
    if (!(distance > 0) || !std::isfinite(distance))
        throw Error(ErrorKind::bad_input, "level set: the distance must be positive and finite");
    std::vector<LevelArc> arcs;
    FaceArcs faces(surface, field, sources, distance);
    for (int f = 0; f < surface.face_count(); ++f) faces.add(f, arcs);
    const std::vector<int> next = Linker(surface, arcs).link(distance);

    std::vector<LevelLoop> loops;
    std::vector<char> begun(arcs.size(), 1), used(arcs.size(), 0);
    for (int i : next)
        if (i != none)
            begun[i] = 0;
    const auto follow = [&](int first) {
        LevelLoop loop;
        int i = first;
        for (; i != none && !used[i]; i = next[i]) {
            used[i] = 1;
            loop.arcs.push_back(arcs[i]);
        }
        loop.closed = i == first;
        // Where the level set touches an edge or a vertex, rounding can leave a speck on its other side.
        double size = 0;
        for (const LevelArc& arc : loop.arcs) size += arc.radius * (arc.to - arc.from);
        if (size > 1e-6 * distance)
            loops.push_back(std::move(loop));
    };
    for (std::size_t i = 0; i < arcs.size(); ++i)
        if (begun[i])
            follow(static_cast<int>(i));
    for (std::size_t i = 0; i < arcs.size(); ++i)
        if (!used[i])
            follow(static_cast<int>(i));
    return loops;
}

SurfacePath sampled(const Surface& surface, const LevelLoop& loop, double tolerance) {
    SurfacePath path;
    path.closed = loop.closed;
    for (const LevelArc& arc : loop.arcs) {
        const double step = 2 * std::acos(std::clamp(1 - tolerance / arc.radius, 0.5, 1 - 1e-12));
        const int pieces = std::max(1, static_cast<int>(std::ceil((arc.to - arc.from) / step)));
        for (int i = 0; i < pieces; ++i)
            path.points.push_back(point_on(surface, arc, i == 0 ? arc.from : arc.from + (arc.to - arc.from) * i / pieces));
    }
    if (!loop.closed)
        path.points.push_back(point_on(surface, loop.arcs.back(), loop.arcs.back().to));
    return path;
}

}  // namespace pvg
