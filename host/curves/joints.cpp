#include "curves/joints.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <unordered_set>
#include <utility>

#include "curves/snap.h"

namespace pvg {
namespace {

constexpr double reach_of_edge = 0.1;
constexpr double same = 1e-12;  // of an edge: nothing to move

double local_edge(const Surface& surface, int face) {
    return (surface.length(3 * face) + surface.length(3 * face + 1) + surface.length(3 * face + 2)) / 3;
}

/// The share of a segment at which it is nearest to a point.
double nearest_share(const Point& at, const Point& from, const Point& to) {
    const Point along = to - from;
    const double squared = along.squaredNorm();
    return squared > 0 ? std::clamp((at - from).dot(along) / squared, 0.0, 1.0) : 0;
}

/// Puts the way from point i to `to`, that one included, behind point i. t_to: its parameter.
std::size_t lead(const Surface& surface, SampledCurve& curve, std::size_t i, const SurfacePoint& to, double t_to) {
    const SurfacePoint from = curve.path.points[i];
    std::vector<SurfacePoint> way{from, to};
    if (common_face(surface, from, to) == none)
        way = straightened_path(surface, from, to).points;
    const double t_from = curve.t[i], whole = length(surface, {way, false});
    double gone = 0;
    for (std::size_t k = 1; k < way.size(); ++k) {
        gone += (surface.position(way[k]) - surface.position(way[k - 1])).norm();
        const double t = k + 1 == way.size() || !(whole > 0) ? t_to : t_from + (t_to - t_from) * std::min(1.0, gone / whole);
        const auto place = static_cast<std::ptrdiff_t>(i + k);
        curve.path.points.insert(curve.path.points.begin() + place, k + 1 == way.size() ? to : way[k]);
        curve.t.insert(curve.t.begin() + place, t);
    }
    return i + way.size() - 1;
}

void erase(SampledCurve& curve, std::size_t begin, std::size_t end) {
    curve.path.points.erase(curve.path.points.begin() + static_cast<std::ptrdiff_t>(begin),
                            curve.path.points.begin() + static_cast<std::ptrdiff_t>(end));
    curve.t.erase(curve.t.begin() + static_cast<std::ptrdiff_t>(begin), curve.t.begin() + static_cast<std::ptrdiff_t>(end));
}

/// The same curve run the other way, with parameters 1 - t.
void reverse(SampledCurve& curve) {
    std::reverse(curve.path.points.begin(), curve.path.points.end());
    std::reverse(curve.t.begin(), curve.t.end());
    for (double& t : curve.t) t = 1 - t;
}

}  // namespace

double Joints::reach(const SurfacePoint& at) const { return reach_of_edge * local_edge(*surface_, at.face); }

/// Faces that reach into the ball around a point and hang together with its face.
std::vector<int> Joints::faces_near(const SurfacePoint& at, double radius) const {
    const Point center = surface_->position(at);
    std::vector<int> found{at.face};
    std::unordered_set<int> seen{at.face};
    for (std::size_t i = 0; i < found.size(); ++i)
        for (int h = 3 * found[i]; h < 3 * found[i] + 3; ++h) {
            const int twin = surface_->twin(h);
            if (twin == none || !seen.insert(twin / 3).second)
                continue;
            const auto& [a, b, c] = surface_->face(twin / 3);
            const Eigen::Vector3d bary = closest_in_triangle(center, surface_->point(a), surface_->point(b), surface_->point(c));
            if (bary.allFinite() && (surface_->position({twin / 3, bary}) - center).norm() <= radius)
                found.push_back(twin / 3);
        }
    return found;
}

bool Joints::meet(SampledCurve& curve, bool at_end) const {
    const SurfacePoint end = curve.path.points.back();
    const Point place = surface_->position(end);
    const double radius = reach(end);
    const double whole = length(*surface_, curve.path);
    double nearest = std::numeric_limits<double>::infinity();
    SurfacePoint target;
    const auto offer = [&](const SurfacePoint& at) {
        const double away = (surface_->position(at) - place).norm();
        if (away > radius || away >= nearest)
            return;
        nearest = away;
        target = at;
    };
    const std::vector<int> around = faces_near(end, radius);
    for (int face : around)
        if (const auto found = tips_near_.find(face); found != tips_near_.end())
            for (int tip : found->second) offer(tips_[tip]);
    if (at_end && whole > 10 * radius)
        offer(curve.path.points.front());
    const bool at_tip = target.face != none;
    if (!at_tip)
        for (int face : around) {
            const auto offer_nearest = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
                const double s = nearest_share(place, surface_->position({face, from}), surface_->position({face, to}));
                offer({face, (1 - s) * from + s * to});
            };
            if (const auto found = pieces_.find(face); found != pieces_.end())
                for (const Piece& piece : found->second) offer_nearest(piece.from, piece.to);
            for (int k = 0; k < 3; ++k)
                if (surface_->twin(3 * face + k) == none)
                    offer_nearest(Eigen::Vector3d::Unit(k), Eigen::Vector3d::Unit((k + 1) % 3));
        }
    // The path's own earlier part counts where it has been away since; it gets a point there.
    const auto& points = curve.path.points;
    std::size_t own = points.size();
    double own_share = 0, gone = 0;
    for (std::size_t i = points.size() - 1; i-- > 0;) {
        const Point from = surface_->position(points[i]), to = surface_->position(points[i + 1]);
        gone += (to - from).norm();
        if (gone < 10 * radius)
            continue;
        const int face = common_face(*surface_, points[i], points[i + 1]);
        if (std::find(around.begin(), around.end(), face) == around.end())
            continue;
        const double s = nearest_share(place, from, to), before = nearest;
        if (!at_tip)
            offer({face, (1 - s) * bary_in(*surface_, face, points[i]) + s * bary_in(*surface_, face, points[i + 1])});
        if (nearest < before) {
            own = i;
            own_share = s;
        }
    }
    if (target.face == none)
        return false;
    if (own < points.size()) {
        const double t = (1 - own_share) * curve.t[own] + own_share * curve.t[own + 1];
        const auto behind = static_cast<std::ptrdiff_t>(own + 1);
        curve.path.points.insert(curve.path.points.begin() + behind, target);
        curve.t.insert(curve.t.begin() + behind, t);
    }
    if (nearest <= same * local_edge(*surface_, end.face))
        return true;
    if (whole < 4 * nearest)
        return false;  // it would be bent out of shape, or pulled to a point

    // The new end is approached from where the path was well away from the old one: no hook where it ran too far.
    std::size_t kept = curve.path.points.size() - 1;
    while (kept > 1 && (surface_->position(curve.path.points[kept - 1]) - place).norm() < 3 * nearest) --kept;
    erase(curve, kept, curve.path.points.size());
    lead(*surface_, curve, kept - 1, target, 1);
    return true;
}

void Joints::pass_through_tips(SampledCurve& curve) const {
    // Per tip: the nearest piece of the path.
    struct Pass {
        int tip;
        double away, t;
    };
    std::vector<Pass> passes;
    const auto& points = curve.path.points;
    const std::size_t pieces = curve.path.closed ? points.size() : points.size() - 1;
    for (std::size_t i = 0; i < pieces; ++i) {
        const SurfacePoint &a = points[i], &b = points[(i + 1) % points.size()];
        const int face = common_face(*surface_, a, b);
        const auto found = tips_near_.find(face);
        if (found == tips_near_.end())
            continue;
        const Point from = surface_->position(a), to = surface_->position(b);
        for (int tip : found->second) {
            if (!loose_[tip])
                continue;
            const Point place = surface_->position(tips_[tip]);
            const double s = nearest_share(place, from, to), away = (from + s * (to - from) - place).norm();
            if (away > reach(tips_[tip]))
                continue;
            const double t = curve.t[i] + s * ((i + 1 < points.size() ? curve.t[i + 1] : 1) - curve.t[i]);
            const auto known = std::find_if(passes.begin(), passes.end(), [&](const Pass& pass) { return pass.tip == tip; });
            if (known == passes.end())
                passes.push_back({tip, away, t});
            else if (away < known->away)
                *known = {tip, away, t};
        }
    }
    for (const Pass& pass : passes) {
        const SurfacePoint& tip = tips_[pass.tip];
        const Point place = surface_->position(tip);
        const auto away = [&](std::size_t i) { return (surface_->position(points[i]) - place).norm(); };
        const std::size_t last = points.size() - 1;
        std::size_t behind = static_cast<std::size_t>(std::upper_bound(curve.t.begin(), curve.t.end(), pass.t) - curve.t.begin());
        std::size_t before = behind == 0 ? 0 : behind - 1;
        const double nothing = same * local_edge(*surface_, tip.face);
        if (away(before) <= nothing || (behind <= last && away(behind) <= nothing))
            continue;
        if (!curve.path.closed && (before >= last || behind > last))
            continue;  // at the path's own end
        // A closed path keeps its first point, where t = 0; the way back to it counts as one more point.
        while (before > 0 && away(before) < 2 * pass.away) --before;
        while (behind < last && away(behind) < 2 * pass.away) ++behind;
        const SurfacePoint next = points[behind % points.size()];
        const double t_next = behind <= last ? curve.t[behind] : 1;
        erase(curve, before + 1, std::min(behind, last + 1));
        const std::size_t at = lead(*surface_, curve, before, tip, std::clamp(pass.t, curve.t[before], t_next));
        const std::size_t reached = lead(*surface_, curve, at, next, t_next);
        erase(curve, reached, reached + 1);  // the next point stands there already
    }
}

std::array<bool, 2> Joints::join(SampledCurve& curve) const {
    std::array<bool, 2> met{false, false};
    if (!curve.path.closed) {
        SampledCurve backwards = curve;
        reverse(backwards);
        met[0] = meet(backwards, false);
        const SurfacePoint &begin = backwards.path.points.back(), &drawn = curve.path.points.front();
        if (begin.face != drawn.face || begin.bary != drawn.bary || backwards.path.points.size() != curve.path.points.size()) {
            reverse(backwards);
            curve = std::move(backwards);
        }
        met[1] = meet(curve, true);
    }
    pass_through_tips(curve);
    return met;
}

void Joints::add(const Imprinter& imprinter, const CurveChain& chain, std::array<bool, 2> met) {
    std::vector<SurfacePoint> at;
    for (int v : chain.vertices) at.push_back(imprinter.parent_point(v));
    const std::size_t pieces = chain.closed ? at.size() : at.size() - 1;
    for (std::size_t i = 0; i < pieces; ++i) {
        const SurfacePoint &a = at[i], &b = at[(i + 1) % at.size()];
        const int face = common_face(*surface_, a, b);
        if (face != none)
            pieces_[face].push_back({bary_in(*surface_, face, a), bary_in(*surface_, face, b)});
    }
    if (chain.closed)
        return;
    for (const bool last : {false, true}) {
        const SurfacePoint& tip = last ? at.back() : at.front();
        const int number = static_cast<int>(tips_.size());
        tips_.push_back(tip);
        loose_.push_back(!met[last]);
        for (int face : faces_near(tip, reach(tip))) tips_near_[face].push_back(number);
    }
}

}  // namespace pvg
