#include "curves/curve_path.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "pvg/status.h"

namespace pvg {
namespace {

constexpr double of_edge = 0.05;  // default chord tolerance
constexpr double of_polygon = 1.0 / 200;
constexpr int deepest = 12;  // halvings of one segment
constexpr int highest_degree = 7;

[[noreturn]] void refuse(const std::string& what) { throw Error(ErrorKind::bad_input, what); }

/// Mean edge length of a point's face.
double local_edge(const Surface& surface, const SurfacePoint& at) {
    return (surface.length(3 * at.face) + surface.length(3 * at.face + 1) + surface.length(3 * at.face + 2)) / 3;
}

/// Puts pieces one after another. Each piece ends at a known curve parameter.
class Assembly {
public:
    Assembly(const Surface& surface, const SurfacePoint& start) : surface_(surface), points_{start}, at_{0}, parameter_{0} {}

    /// The piece's first point is the last one so far. end: curve parameter at the piece's end.
    void append(const SurfacePath& piece, double end) {
        const double whole = length(surface_, piece);
        const double begin = parameter_.back(), before = at_.back();
        double gone = 0;
        for (std::size_t i = 1; i < piece.points.size(); ++i) {
            gone += (surface_.position(piece.points[i]) - surface_.position(piece.points[i - 1])).norm();
            points_.push_back(piece.points[i]);
            at_.push_back(before + gone);
            parameter_.push_back(
                i + 1 == piece.points.size() || !(whole > 0) ? end : begin + (end - begin) * std::min(1.0, gone / whole));
        }
    }

    SampledCurve finish(const CurveOptions& options) && {
        SampledCurve curve;
        curve.path.closed = options.closed;
        curve.t.resize(points_.size());
        const double whole = at_.back();
        for (std::size_t i = 0; i < points_.size(); ++i) {
            const double by_arc =
                whole > 0 ? at_[i] / whole : static_cast<double>(i) / std::max<std::size_t>(1, points_.size() - 1);
            curve.t[i] = options.parameter_curve ? parameter_[i] : by_arc;
        }
        curve.t.back() = 1;
        if (options.closed) {  // the last point is the first
            points_.pop_back();
            curve.t.pop_back();
        }
        curve.path.points = std::move(points_);
        return curve;
    }

private:
    const Surface& surface_;
    std::vector<SurfacePoint> points_;
    std::vector<double> at_;
    std::vector<double> parameter_;
};

/// Bezier segments end to end: the last point of one is the first of the next.
class BezierChain {
public:
    BezierChain(const Surface& surface, const CurveOptions& options) : surface_(surface), options_(options) {}

    SampledCurve sample(const std::vector<std::vector<SurfacePoint>>& segments) const {
        Assembly assembly(surface_, segments.front().front());
        const double count = static_cast<double>(segments.size());
        for (std::size_t i = 0; i < segments.size(); ++i) {
            std::vector<SurfacePath> legs;
            const double polygon = join(segments[i], legs);
            halve(segments[i], legs, polygon, polygon, i / count, (i + 1) / count, 0, assembly);
        }
        return std::move(assembly).finish(options_);
    }

private:
    /// The geodesics between control points; returns their length.
    double join(const std::vector<SurfacePoint>& control, std::vector<SurfacePath>& legs) const {
        double sum = 0;
        legs.clear();
        for (std::size_t k = 0; k + 1 < control.size(); ++k) {
            legs.push_back(straightened_path(surface_, control[k], control[k + 1]));
            sum += length(surface_, legs.back());
        }
        return sum;
    }

    void halve(const std::vector<SurfacePoint>& control, const std::vector<SurfacePath>& legs, double polygon, double whole,
               double begin, double end, int depth, Assembly& assembly) const {
        const SurfacePath chord =
            control.size() == 2 ? legs.front() : straightened_path(surface_, control.front(), control.back());
        const double straight = length(surface_, chord);
        double tolerance = options_.tolerance;
        if (!(tolerance > 0))
            tolerance = std::min(of_edge * std::min(local_edge(surface_, control.front()), local_edge(surface_, control.back())),
                                 of_polygon * whole);
        // A polygon of this length between the chord's ends stays inside an ellipse with this half axis.
        const double away = 0.5 * std::sqrt(std::max(0.0, polygon * polygon - straight * straight));
        if (control.size() == 2 || away <= tolerance || depth == deepest) {
            assembly.append(chord, end);
            return;
        }
        // De Casteljau at 1/2: the first and the last point of every level are the control points of the halves.
        std::vector<SurfacePoint> first{control.front()}, second{control.back()};
        std::vector<SurfacePoint> level;
        for (const SurfacePath& leg : legs) level.push_back(point_along(surface_, leg, 0.5));
        for (;;) {
            first.push_back(level.front());
            second.push_back(level.back());
            if (level.size() == 1)
                break;
            for (std::size_t k = 0; k + 1 < level.size(); ++k)
                level[k] = geodesic_interpolation(surface_, level[k], level[k + 1], 0.5);
            level.pop_back();
        }
        std::reverse(second.begin(), second.end());
        const double middle = 0.5 * (begin + end);
        std::vector<SurfacePath> new_legs;
        const double first_polygon = join(first, new_legs);
        halve(first, new_legs, first_polygon, whole, begin, middle, depth + 1, assembly);
        const double second_polygon = join(second, new_legs);
        halve(second, new_legs, second_polygon, whole, middle, end, depth + 1, assembly);
    }

    const Surface& surface_;
    const CurveOptions& options_;
};

}  // namespace

SurfacePoint geodesic_interpolation(const Surface& surface, const SurfacePoint& from, const SurfacePoint& to, double s) {
    if (s <= 0)
        return from;
    if (s >= 1)
        return to;
    return point_along(surface, straightened_path(surface, from, to), s);
}

/// The shortest path by way of a straightened one: as long as the straight line in space, that one is the shortest already;
/// else its length bounds the search.
static SurfacePath exact_segment(const Surface& surface, const SurfacePoint& from, const SurfacePoint& to) {
    SurfacePath straightened = straightened_path(surface, from, to);
    const double bound = length(surface, straightened), space = (surface.position(from) - surface.position(to)).norm();
    if (bound <= space * (1 + 1e-12))
        return straightened;
    return shortest_path(surface, from, to, bound);
}

SampledCurve polyline_curve(const Surface& surface, std::span<const SurfacePoint> points, const CurveOptions& options) {
    const std::size_t count = points.size(), least = options.closed ? 3 : 2;
    if (count < least)
        refuse("polyline: " + std::to_string(count) + " points, at least " + std::to_string(least) + " are needed");
    const std::size_t pieces = options.closed ? count : count - 1;
    Assembly assembly(surface, points[0]);
    for (std::size_t i = 0; i < pieces; ++i)
        assembly.append(exact_segment(surface, points[i], points[(i + 1) % count]),
                        static_cast<double>(i + 1) / static_cast<double>(pieces));
    return std::move(assembly).finish(options);
}

SampledCurve bezier_curve(const Surface& surface, std::span<const SurfacePoint> points, int degree, const CurveOptions& options) {
    if (degree < 1 || degree > highest_degree)
        refuse("bezier: degree " + std::to_string(degree) + " is not in 1.." + std::to_string(highest_degree));
    const std::size_t step = static_cast<std::size_t>(degree), count = points.size();
    if (options.closed ? count == 0 || count % step != 0 : count < 2 || (count - 1) % step != 0)
        refuse("bezier: " + std::to_string(count) + " points do not make whole segments of degree " + std::to_string(degree) +
               "; right would be a multiple of it" + (options.closed ? "" : " plus 1"));
    const std::size_t segments = (options.closed ? count : count - 1) / step;
    std::vector<std::vector<SurfacePoint>> control(segments);
    for (std::size_t i = 0; i < segments; ++i)
        for (std::size_t k = 0; k <= step; ++k) control[i].push_back(points[(i * step + k) % count]);
    return BezierChain(surface, options).sample(control);
}

SampledCurve bspline_curve(const Surface& surface, std::span<const SurfacePoint> points, int degree,
                           const CurveOptions& options) {
    if (degree < 1 || degree > highest_degree)
        refuse("bspline: degree " + std::to_string(degree) + " is not in 1.." + std::to_string(highest_degree));
    const int d = degree, n = static_cast<int>(points.size());
    const int least = options.closed ? 3 : d + 1;
    if (n < least)
        refuse("bspline: " + std::to_string(n) + " points, a " +
               (options.closed ? "closed curve" : "curve of degree " + std::to_string(d)) + " needs at least " +
               std::to_string(least));
    const int segments = options.closed ? n : n - d;

    // Segment i runs over [i, i + 1]. Its inner Bezier points are the blossom's values at (i, ..., i, i + 1, ..., i + 1) with at
    // least one of each: a blossom of degree d - 2 over those d - 1 control points that have both knots (L. Ramshaw, 1989), so
    // few interpolations are needed. A closed curve begins nearest to its first control point.
    const int shift = options.closed ? (d - 1) / 2 : 0;
    const auto knot = [&](int k) { return static_cast<double>(options.closed ? k : std::clamp(k, 0, segments)); };
    std::vector<std::vector<SurfacePoint>> control(segments, std::vector<SurfacePoint>(d + 1));
    for (int i = 0; i < segments; ++i)
        for (int j = 1; j < d; ++j) {
            std::vector<SurfacePoint> level;
            std::vector<double> around;  // the d - 2 knots before i, the d - 2 after i + 1
            for (int k = 1; k < d; ++k) level.push_back(points[(i + k - shift + n * d) % n]);
            for (int k = d - 2; k > 0; --k) around.push_back(knot(i - k));
            for (int k = 1; k <= d - 2; ++k) around.push_back(knot(i + 1 + k));
            for (int m = 1; m <= d - 2; ++m) {
                const double argument = m <= d - 1 - j ? i : i + 1;
                for (int k = 0; k + m < d - 1; ++k) {
                    const double low = around[k + m - 1], high = around[k + d - 2];
                    level[k] = geodesic_interpolation(surface, level[k], level[k + 1], (argument - low) / (high - low));
                }
            }
            control[i][j] = level.front();
        }
    // At a knot between segments the curve is half-way between their nearest inner points: C1.
    for (int i = 0; i < segments; ++i) {
        const bool first = i == 0 && !options.closed;
        SurfacePoint at = points[i];
        if (d > 1 && !first)
            at = geodesic_interpolation(surface, control[(i + segments - 1) % segments][d - 1], control[i][1], 0.5);
        control[i].front() = at;
        if (!first)
            control[(i + segments - 1) % segments].back() = at;
    }
    if (!options.closed)
        control.back().back() = points[n - 1];
    return BezierChain(surface, options).sample(control);
}

SampledCurve circle_curve(const Surface& surface, const SurfacePoint& center, double radius, const SurfacePoint& start,
                          const CurveOptions& options) {
    if (!(radius > 0) || !std::isfinite(radius))
        refuse("circle: radius " + std::to_string(radius) + " is not positive");
    const double tolerance =
        options.tolerance > 0 ? options.tolerance : std::min(of_edge * local_edge(surface, center), of_polygon * radius);
    SampledCurve curve;
    curve.path = geodesic_circle(surface, center, radius, start, tolerance);
    const double whole = length(surface, curve.path);
    double gone = 0;
    for (std::size_t i = 0; i < curve.path.points.size(); ++i) {
        if (i > 0)
            gone += (surface.position(curve.path.points[i]) - surface.position(curve.path.points[i - 1])).norm();
        curve.t.push_back(whole > 0 ? gone / whole : 0);
    }
    return curve;
}

}  // namespace pvg
