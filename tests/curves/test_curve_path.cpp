// Curves from control points: against the same curves in the plane, and on curved and coarse surfaces. Closest points against
// brute force.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "curves/curve_path.h"
#include "curves/imprint.h"
#include "curves/snap.h"
#include "fixtures/meshes.h"
#include "pvg/status.h"

namespace pvg {
namespace {

using fixtures::Random;
using Vector2 = Eigen::Vector2d;

std::vector<SurfacePoint> on_plane(const Surface& flat, const std::vector<Vector2>& points) {
    std::vector<SurfacePoint> at;
    for (const Vector2& p : points) at.push_back(fixtures::locate_flat(flat, p.x(), p.y()));
    return at;
}

/// Uniform B-spline by the Cox - de Boor recursion. Segment i runs over [i, i + 1].
Vector2 planar_bspline(const std::vector<Vector2>& p, int d, bool closed, double t) {
    const int n = static_cast<int>(p.size()), segments = closed ? n : n - d;
    const auto knot = [&](int k) { return closed ? k - d : std::clamp(k - d, 0, segments); };  // k = 0 .. n + d
    const int span = std::min(static_cast<int>(t), segments - 1);
    std::vector<double> value(segments + 3 * d + 2, 0);
    value[span + d] = 1;
    for (int q = 1; q <= d; ++q)
        for (int k = 0; k <= span + d; ++k) {
            const double a = knot(k + q) - knot(k), b = knot(k + q + 1) - knot(k + 1);
            value[k] = (a > 0 ? (t - knot(k)) / a * value[k] : 0) + (b > 0 ? (knot(k + q + 1) - t) / b * value[k + 1] : 0);
        }
    Vector2 at(0, 0);
    const int shift = closed ? (d - 1) / 2 : 0;
    for (int k = 0; k <= span + d; ++k) at += value[k] * p[((k - shift) % n + n) % n];
    return at;
}

void expect_path(const Surface& surface, const SampledCurve& curve) {
    const std::size_t n = curve.path.points.size();
    ASSERT_EQ(curve.t.size(), n);
    EXPECT_EQ(curve.t.front(), 0);
    EXPECT_TRUE(curve.path.closed || curve.t.back() == 1);
    for (std::size_t i = 0; i < n; ++i) {
        EXPECT_NEAR(curve.path.points[i].bary.sum(), 1, 1e-12);
        EXPECT_GE(curve.path.points[i].bary.minCoeff(), 0);
        if (i + 1 == n && !curve.path.closed)
            break;
        EXPECT_NE(common_face(surface, curve.path.points[i], curve.path.points[(i + 1) % n]), none) << i;
        EXPECT_LE(curve.t[i], i + 1 < n ? curve.t[i + 1] : 1);
    }
}

const std::vector<Vector2> winding{{0.1, 0.2},  {0.35, 0.9}, {0.5, 0.15}, {0.8, 0.3}, {0.9, 0.8},
                                   {0.55, 0.7}, {0.3, 0.55}, {0.15, 0.4}, {0.2, 0.3}, {0.6, 0.4}};

TEST(CurvePath, BsplineInThePlaneIsThePlanarSpline) {
    for (int degree = 1; degree <= 7; ++degree)
        for (bool closed : {false, true}) {
            SCOPED_TRACE(std::to_string(degree) + (closed ? " closed" : " open"));
            const Surface flat = fixtures::irregular_plane(12, 12);
            CurveOptions options{closed, true, 1e-3};
            const SampledCurve curve = bspline_curve(flat, on_plane(flat, winding), degree, options);
            expect_path(flat, curve);
            const int segments = static_cast<int>(winding.size()) - (closed ? 0 : degree);
            int on_curve = 0;
            for (std::size_t i = 0; i < curve.path.points.size(); ++i) {
                const Vector2 expected = planar_bspline(winding, degree, closed, curve.t[i] * segments);
                const double away = (flat.position(curve.path.points[i]).head<2>() - expected).norm();
                // Samples lie at halves of halves of segments; the points between them are where chords cross edges.
                const double halves = curve.t[i] * segments * 4096;
                if (std::abs(halves - std::round(halves)) < 1e-9) {
                    EXPECT_LT(away, 1e-9);  // rounding of a few hundred interpolations
                    ++on_curve;
                } else if (degree > 1) {
                    EXPECT_LT(away, 1e-2);  // the chord's tolerance, and t that is not linear along it
                }
            }
            EXPECT_GE(on_curve, segments);
        }
}

TEST(CurvePath, ChordsKeepTheTolerance) {
    const Surface flat = fixtures::plane(1, 1);
    for (double tolerance : {1e-2, 1e-3, 1e-4}) {
        const SampledCurve curve = bspline_curve(flat, on_plane(flat, winding), 3, {false, true, tolerance});
        for (int k = 0; k <= 1000; ++k) {
            const Vector2 at = planar_bspline(winding, 3, false, k * 7 / 1000.0);
            double nearest = 1;
            for (std::size_t i = 0; i + 1 < curve.path.points.size(); ++i) {
                const Vector2 a = flat.position(curve.path.points[i]).head<2>(),
                              b = flat.position(curve.path.points[i + 1]).head<2>();
                const double s = std::clamp((at - a).dot(b - a) / std::max((b - a).squaredNorm(), 1e-300), 0.0, 1.0);
                nearest = std::min(nearest, (a + s * (b - a) - at).norm());
            }
            EXPECT_LE(nearest, tolerance);
        }
    }
}

TEST(CurvePath, BezierInThePlane) {
    const Surface flat = fixtures::irregular_plane(10, 10);
    const std::vector<Vector2> p{{0.1, 0.1}, {0.2, 0.9}, {0.7, 0.8}, {0.8, 0.3}, {0.9, 0.05}, {0.5, 0.4}, {0.3, 0.2}};
    const SampledCurve curve = bezier_curve(flat, on_plane(flat, p), 3, {false, true, 1e-3});
    expect_path(flat, curve);
    for (std::size_t i = 0; i < curve.t.size(); ++i) {
        const double scaled = curve.t[i] * 2, halves = scaled * 4096;
        if (std::abs(halves - std::round(halves)) > 1e-9)
            continue;
        const int s = scaled >= 1 ? 1 : 0;
        const double t = scaled - s, r = 1 - t;
        const Vector2 expected =
            r * r * r * p[3 * s] + 3 * r * r * t * p[3 * s + 1] + 3 * r * t * t * p[3 * s + 2] + t * t * t * p[3 * s + 3];
        EXPECT_LT((flat.position(curve.path.points[i]).head<2>() - expected).norm(), 1e-9);
    }
    EXPECT_THROW(bezier_curve(flat, on_plane(flat, {p[0], p[1], p[2]}), 3), Error);
    EXPECT_THROW(bezier_curve(flat, on_plane(flat, {p[0], p[1]}), 8), Error);
    EXPECT_THROW(bspline_curve(flat, on_plane(flat, {p[0], p[1], p[2]}), 3), Error);
    EXPECT_EQ(bezier_curve(flat, on_plane(flat, {p[0], p[1], p[2], p[3], p[4], p[5]}), 3, {true}).path.closed, true);
}

TEST(CurvePath, ArcLengthParameterIsLinear) {
    const Surface sphere = fixtures::icosphere(12);
    Random random(3);
    std::vector<SurfacePoint> points;
    for (int i = 0; i < 5; ++i) points.push_back({random.below(sphere.face_count()), {0.2, 0.3, 0.5}});
    for (bool closed : {false, true}) {
        const SampledCurve curve = bspline_curve(sphere, points, 2, {closed});
        expect_path(sphere, curve);
        const double whole = length(sphere, curve.path);
        double gone = 0;
        for (std::size_t i = 1; i < curve.t.size(); ++i) {
            gone += (sphere.position(curve.path.points[i]) - sphere.position(curve.path.points[i - 1])).norm();
            EXPECT_NEAR(curve.t[i], gone / whole, 1e-12);
        }
    }
}

TEST(CurvePath, ClosedSplinesAreSmoothLoopsOnASphere) {
    const Surface sphere = fixtures::icosphere(24);
    const ClosestPointTree tree(sphere);
    std::vector<SurfacePoint> points;
    for (int i = 0; i < 8; ++i) {
        const double a = 2 * std::numbers::pi * i / 8;
        points.push_back(tree.closest(Point(std::cos(a), std::sin(a), 0.8)).at);
    }
    for (int degree : {2, 3, 4, 5}) {
        const SampledCurve curve = bspline_curve(sphere, points, degree, {true});
        expect_path(sphere, curve);
        // By symmetry nearly a circle of latitude; the spline stays inside the control polygon's band.
        double low = 2, high = -2;
        for (const SurfacePoint& p : curve.path.points) {
            low = std::min(low, sphere.position(p).z());
            high = std::max(high, sphere.position(p).z());
        }
        EXPECT_LT(high - low, 0.02);
        Imprinter imprinter(sphere);
        const int chain = imprinter.imprint(curve.path, curve.t);
        EXPECT_TRUE(imprinter.is_simple(chain));
        EXPECT_TRUE(imprinter.chain(chain).closed);
    }
}

TEST(CurvePath, CoincidentControlPoints) {
    const Surface flat = fixtures::irregular_plane(6, 6);
    const Vector2 a(0.2, 0.2), b(0.8, 0.7);
    for (int degree : {2, 3, 5}) {
        const SampledCurve curve =
            bspline_curve(flat, on_plane(flat, {a, a, a, a, a, b, b, b, b, b, b}), degree, {false, false, 1e-3});
        expect_path(flat, curve);
        EXPECT_NEAR(length(flat, curve.path), (b - a).norm(), 1e-9);
        Imprinter imprinter(flat);
        EXPECT_TRUE(imprinter.is_simple(imprinter.imprint(curve.path, curve.t)));
    }
    // A curve that is one point has a path of length 0; imprinting it is refused.
    const SampledCurve dot = bspline_curve(flat, on_plane(flat, {a, a, a, a}), 3);
    EXPECT_EQ(length(flat, dot.path), 0);
    EXPECT_THROW(Imprinter(flat).imprint(dot.path, dot.t), Error);
}

TEST(CurvePath, PolylineIsExactAndPassesItsPoints) {
    const Surface box = fixtures::rotated(fixtures::cuboid(1, 1, 1), 0.5);
    const std::vector<SurfacePoint> points{{2, {0.2, 0.3, 0.5}}, {4, {0.5, 0.25, 0.25}}, {9, {0.3, 0.3, 0.4}}};
    for (bool closed : {false, true}) {
        const SampledCurve curve = polyline_curve(box, points, {closed, true});
        expect_path(box, curve);
        double sum = 0;
        for (std::size_t i = 0; i + (closed ? 0 : 1) < points.size(); ++i)
            sum += length(box, shortest_path(box, points[i], points[(i + 1) % 3]));
        EXPECT_NEAR(length(box, curve.path), sum, 1e-12);
        for (std::size_t k = 0; k < points.size(); ++k) {
            const double t = static_cast<double>(k) / (closed ? 3 : 2);
            const auto at = std::find_if(curve.t.begin(), curve.t.end(), [&](double u) { return std::abs(u - t) < 1e-12; });
            ASSERT_NE(at, curve.t.end());
            EXPECT_LT((box.position(curve.path.points[at - curve.t.begin()]) - box.position(points[k])).norm(), 1e-12);
        }
    }
}

TEST(CurvePath, CircleInThePlane) {
    const Surface flat = fixtures::irregular_plane(16, 16);
    const SurfacePoint center = fixtures::locate_flat(flat, 0.47, 0.52), start = fixtures::locate_flat(flat, 0.9, 0.52);
    const SampledCurve curve = circle_curve(flat, center, 0.3, start, {true, false, 1e-5});
    expect_path(flat, curve);
    EXPECT_TRUE(curve.path.closed);
    for (std::size_t i = 0; i < curve.t.size(); ++i) {
        const Vector2 d = flat.position(curve.path.points[i]).head<2>() - Vector2(0.47, 0.52);
        EXPECT_NEAR(d.norm(), 0.3, 1e-9);
        double angle = std::atan2(d.y(), d.x());
        if (angle < -1e-6)
            angle += 2 * std::numbers::pi;
        EXPECT_NEAR(curve.t[i], angle / (2 * std::numbers::pi), 1e-4);  // arcs are replaced by chords
    }
}

TEST(StraightenedPath, IsLocallyShortest) {
    const Surface bumpy = fixtures::lifted(fixtures::irregular_plane(16, 16),
                                           [](double x, double y) { return 0.1 * std::sin(12 * x) * std::sin(9 * y); });
    struct Case {
        Surface surface;
        double mean;  // of length over the shortest; other local minima cost a little on average
    };
    for (const Case& c : {Case{fixtures::irregular_plane(12, 12), 1 + 1e-9}, Case{fixtures::l_shape(5), 1 + 1e-9},
                          Case{fixtures::icosphere(6), 1.001}, Case{bumpy, 1.005}, Case{fixtures::torus(20, 12), 1.02},
                          Case{fixtures::slit_plane(4), 1.02}, Case{fixtures::cuboid(), 1.05}}) {
        Random random(9);
        double sum = 0;
        int count = 0;
        for (int i = 0; i < 60; ++i) {
            SurfacePoint ends[2];
            for (SurfacePoint& p : ends) {
                p.face = random.below(c.surface.face_count());
                p.bary = Eigen::Vector3d(random.real(), random.real(), random.real());
                if (i % 3 == 1)
                    p.bary[random.below(3)] = 0;
                if (i % 3 == 2)
                    p.bary = Eigen::Vector3d::Unit(random.below(3));
                p.bary /= p.bary.sum();
            }
            const SurfacePath path = straightened_path(c.surface, ends[0], ends[1]);
            for (std::size_t k = 0; k + 1 < path.points.size(); ++k)
                ASSERT_NE(common_face(c.surface, path.points[k], path.points[k + 1]), none);
            ASSERT_EQ(c.surface.position(path.points.front()), c.surface.position(ends[0]));
            ASSERT_EQ(c.surface.position(path.points.back()), c.surface.position(ends[1]));
            const double shortest = length(c.surface, shortest_path(c.surface, ends[0], ends[1])),
                         found = length(c.surface, path);
            EXPECT_GE(found, shortest * (1 - 1e-9));
            if (shortest < 1e-9)
                continue;
            sum += found / shortest;
            ++count;
        }
        EXPECT_LE(sum / count, c.mean);
    }
}

TEST(StraightenedPath, DifferentComponentsAreRefused) {
    std::vector<Point> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 0, 0}, {6, 0, 0}, {5, 1, 0}};
    const Surface two(points, {{0, 1, 2}, {3, 4, 5}});
    EXPECT_THROW(straightened_path(two, {0, {0.3, 0.3, 0.4}}, {1, {0.3, 0.3, 0.4}}), Error);
}

TEST(SurfacePathPoints, PointAlongDividesTheLength) {
    const Surface sphere = fixtures::icosphere(8);
    const SurfacePath path = straightened_path(sphere, {0, {0.2, 0.3, 0.5}}, {300, {0.6, 0.2, 0.2}});
    EXPECT_EQ(sphere.position(point_along(sphere, path, 0)), sphere.position(path.points.front()));
    EXPECT_EQ(sphere.position(point_along(sphere, path, 1)), sphere.position(path.points.back()));
    Point last = sphere.position(path.points.front());
    double sum = 0;
    const int parts = 2000;
    for (int i = 1; i <= parts; ++i) {
        const Point at = sphere.position(point_along(sphere, path, static_cast<double>(i) / parts));
        sum += (at - last).norm();
        last = at;
    }
    EXPECT_NEAR(sum, length(sphere, path), 1e-3 * sum);  // corners are cut
}

TEST(ClosestPointTree, AgreesWithBruteForce) {
    const Surface surface = fixtures::rotated(fixtures::torus(24, 12), 0.8);
    const ClosestPointTree tree(surface);
    Random random(4);
    for (int i = 0; i < 200; ++i) {
        const Point query(random.real(-2, 2), random.real(-2, 2), random.real(-1, 1));
        double best = 1e9;
        for (int f = 0; f < surface.face_count(); ++f) {
            const auto& [a, b, c] = surface.face(f);
            best = std::min(
                best,
                (surface.position({f, closest_in_triangle(query, surface.point(a), surface.point(b), surface.point(c))}) - query)
                    .norm());
        }
        const ClosestPoint found = tree.closest(query);
        EXPECT_NEAR(found.distance, best, 1e-15);
        EXPECT_NEAR((surface.position(found.at) - query).norm(), best, 1e-9);  // cleaned coordinates
    }
}

TEST(ClosestPointTree, TriangleMinimumIsNotBeaten) {
    Random random(6);
    const auto any = [&] { return Point(random.real(-1, 1), random.real(-1, 1), random.real(-1, 1)); };
    for (int i = 0; i < 300; ++i) {
        const Point a = any(), b = any(), c = any(), query = 1.5 * any();
        const Eigen::Vector3d bary = closest_in_triangle(query, a, b, c);
        const double best = (bary[0] * a + bary[1] * b + bary[2] * c - query).norm();
        for (int k = 0; k < 200; ++k) {
            Eigen::Vector3d other(random.real(), random.real(), random.real());
            if (k % 4 == 0)
                other[k / 4 % 3] = 0;
            other /= other.sum();
            EXPECT_GE((other[0] * a + other[1] * b + other[2] * c - query).norm(), best - 1e-14);
        }
    }
}

TEST(ClosestPointTree, VerticesAndEdgesAreClean) {
    const Surface surface = fixtures::rotated(fixtures::icosphere(5), 0.3);
    const ClosestPointTree tree(surface);
    for (int v = 0; v < surface.vertex_count(); v += 7)
        for (double away : {1.0, 1.3}) {
            const ClosestPoint found = tree.closest(away * surface.point(v));
            EXPECT_EQ(found.at.bary.maxCoeff(), 1);
            EXPECT_EQ(surface.position(found.at), surface.point(v));
        }
    for (int h = 0; h < surface.halfedge_count(); h += 11) {
        const ClosestPoint found = tree.closest(0.3 * surface.point(surface.origin(h)) + 0.7 * surface.point(surface.target(h)));
        EXPECT_EQ(found.at.bary.minCoeff(), 0);
        EXPECT_NEAR(found.at.bary.maxCoeff(), 0.7, 1e-12);
    }
}

}  // namespace
}  // namespace pvg
