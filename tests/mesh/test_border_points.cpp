// Laws of the border's points: no negative weight, and still the same problem.
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "fixtures/meshes.h"
#include "mesh/border_points.h"

namespace pvg {
namespace {

using fixtures::cut_open;
using Matrix = Eigen::SparseMatrix<double>;

/// Jittered grid over [0, 1] x [0, squeeze]; triangles far from Delaunay.
Surface slivers(int n, double squeeze, std::uint64_t seed = 3) {
    return fixtures::transformed(fixtures::irregular_plane(n, n, 1, 1, seed),
                                 [&](const Point& p) { return Point(p.x() + 0.7 * p.y(), squeeze * p.y(), 0); });
}

/// Largest positive off-diagonal entry: minus the most negative weight.
double worst_weight(const Matrix& S) {
    double worst = 0;
    for (int column = 0; column < S.outerSize(); ++column)
        for (Matrix::InnerIterator it(S, column); it; ++it)
            if (it.row() != column)
                worst = std::max(worst, it.value());
    return worst;
}

double largest(const Matrix& S) { return S.coeffs().cwiseAbs().maxCoeff(); }

void expect_laplacian(const Matrix& S) {
    EXPECT_LT(largest(Matrix(S - Matrix(S.transpose()))), 1e-12 * largest(S));
    EXPECT_LT((S * Eigen::VectorXd::Ones(S.cols())).cwiseAbs().maxCoeff(), 1e-11 * largest(S));
}

Eigen::VectorXd sampled(const Surface& surface, const std::function<double(const Point&)>& u) {
    Eigen::VectorXd values(surface.vertex_count());
    for (int v = 0; v < values.size(); ++v) values[v] = u(surface.point(v));
    return values;
}

TEST(BorderPoints, ObtuseTriangleByHand) {
    const Surface triangle({{0, 0, 0}, {4, 0, 0}, {1, 1, 0}}, {{0, 1, 2}});
    IntrinsicTriangulation t = intrinsic_triangulation(triangle);
    const std::vector<BorderPoint> points = insert_border_points(t, triangle, {});
    ASSERT_EQ(points.size(), 1u);
    EXPECT_EQ(points[0].from, 0);
    EXPECT_EQ(points[0].to, 1);
    EXPECT_NEAR(points[0].share, 0.25, 1e-15);
    // Two right triangles: weights 1/2, 1/6 along the border and 2 to the corner, their sum 8/3 at the point.
    const Eigen::MatrixXd S = surface_stiffness(triangle, {});
    EXPECT_NEAR(S(0, 2), -0.5 * 2 * 3 / 8, 1e-14);
    EXPECT_NEAR(S(1, 2), -2.0 / 6 * 3 / 8, 1e-14);
    EXPECT_NEAR(S(0, 1), -0.5 / 6 * 3 / 8, 1e-14);
    // Between two fixed ends nothing is inserted; their own weight, -1/4 in the triangle itself, acts on nothing.
    const Eigen::MatrixXd F = surface_stiffness(triangle, {{1, 1, 0}, {}});
    EXPECT_NEAR(F(0, 2), -1.5, 1e-14);
    EXPECT_NEAR(F(1, 2), -0.5, 1e-14);
    EXPECT_EQ(F(0, 1), 0);
    EXPECT_NEAR(F(2, 2), 2, 1e-14);
    EXPECT_NEAR(F(0, 0), 1.5, 1e-14);
}

TEST(BorderPoints, NoWeightIsNegative) {
    for (double squeeze : {0.3, 0.1, 0.01})
        for (const Surface& surface :
             {slivers(16, squeeze), cut_open(slivers(16, squeeze), {{40, 41, 42, 43, 44, 45}, {100, 117, 134, 151}})}) {
            IntrinsicTriangulation t = intrinsic_triangulation(surface);
            make_delaunay(t);
            const double before = worst_weight(cotan_stiffness(t, surface.vertex_count()));
            const Matrix S = surface_stiffness(surface, {});
            EXPECT_GT(before, 0.01) << "the fixture is too good to show anything";
            EXPECT_LE(worst_weight(S), 0);
            expect_laplacian(S);
            // The energy of x cannot be larger than the area, which it is without points.
            const Eigen::VectorXd x = sampled(surface, [](const Point& p) { return p.x(); });
            EXPECT_LE(x.dot(S * x), surface.area() * (1 + 1e-12));
            EXPECT_GT(x.dot(S * x), 0.8 * surface.area());
        }
}

TEST(BorderPoints, PointsKeepTheSurface) {
    const Surface surface =
        fixtures::lifted(slivers(20, 0.05), [](double x, double y) { return 0.2 * std::sin(9 * x + 30 * y); });
    IntrinsicTriangulation t = intrinsic_triangulation(surface);
    const std::vector<BorderPoint> points = insert_border_points(t, surface, {});
    const int all = surface.vertex_count() + static_cast<int>(points.size());
    EXPECT_GT(points.size(), 4u);
    EXPECT_NEAR(lumped_areas(t, all).sum(), surface.area(), 1e-9 * surface.area());
    for (int h = 0; h < static_cast<int>(t.twin.size()); ++h)
        if (t.twin[h] != none) {
            EXPECT_EQ(t.twin[t.twin[h]], h);
            EXPECT_NEAR(t.lengths[h / 3][h % 3], t.lengths[t.twin[h] / 3][t.twin[h] % 3], 1e-12);
        } else {
            EXPECT_GT(opposite_angle(t, h).cosine, -2e-9 * opposite_angle(t, h).scale);
        }
}

TEST(BorderPoints, WhatTheBorderConditionsAllowStaysExact) {
    // y on a strip between two fixed lines, natural on the slanted rest: not a solution. Fixed all around: every linear function.
    const Surface surface = slivers(16, 0.05);
    std::vector<char> all_fixed(surface.vertex_count(), 0), level(surface.vertex_count(), 0);
    for (int v = 0; v < surface.vertex_count(); ++v) all_fixed[v] = surface.is_border_vertex(v);
    const Matrix closed = surface_stiffness(surface, {all_fixed, {}});
    EXPECT_LE(worst_weight(closed), 0);
    expect_laplacian(closed);
    for (const auto& u : {sampled(surface, [](const Point& p) { return p.x(); }),
                          sampled(surface, [](const Point& p) { return p.y() / 0.05; })}) {
        const Eigen::VectorXd force = closed * u;
        for (int v = 0; v < surface.vertex_count(); ++v)
            if (!all_fixed[v]) {
                EXPECT_NEAR(force[v], 0, 1e-11 * largest(closed));
            }
    }
    // x on an upright strip, its lower and upper border natural: no flux leaves there, so forces vanish on them too.
    const Surface strip = fixtures::transformed(fixtures::irregular_plane(40, 6, 1, 1, 8),
                                                [](const Point& p) { return Point(p.x(), 0.02 * p.y(), 0); });
    for (int v = 0; v < strip.vertex_count(); ++v) {
        const double x = strip.point(v).x();
        level[v] = x == 0 || x == 1;
    }
    level.resize(strip.vertex_count());
    IntrinsicTriangulation t = intrinsic_triangulation(strip);
    EXPECT_GT(insert_border_points(t, strip, {level, {}}).size(), 0u);
    const Matrix S = surface_stiffness(strip, {level, {}});
    EXPECT_LE(worst_weight(S), 0);
    const Eigen::VectorXd x = sampled(strip, [](const Point& p) { return p.x(); });
    const Eigen::VectorXd force = S * x;
    for (int v = 0; v < strip.vertex_count(); ++v)
        if (!level[v]) {
            EXPECT_NEAR(force[v], 0, 1e-11 * largest(S));
        }
    EXPECT_NEAR(x.dot(force), strip.area(), 1e-12) << "its energy is the area";
}

/// A strip cut from end to end at half height; the two banks are a sharp Poisson curve.
struct Seam {
    Surface surface;
    BorderConditions border;
    std::vector<int> right;  ///< V: the lower copy of an upper one, else the vertex
};

Seam seam_strip() {
    const int n = 24, rows = 6;
    const Surface whole = fixtures::transformed(fixtures::irregular_plane(n, rows, 1, 1, 4), [&](const Point& p) {
        const bool middle = std::abs(p.y() - 0.5) < 0.08;  // straight again, steps uneven
        return Point(p.x(), 0.06 * (middle ? 0.5 : p.y()), 0);
    });
    std::vector<int> chain;
    for (int i = 0; i <= n; ++i) chain.push_back(rows / 2 * (n + 1) + i);
    // Flips may have removed edges of the line: put the grid's own triangles back.
    const Surface grid = fixtures::plane(n, rows);
    const Surface uncut(whole.points(), grid.faces());
    Seam seam{cut_open(uncut, {chain}), {}, {}};
    const int count = seam.surface.vertex_count();
    std::map<std::array<double, 3>, int> first;
    std::vector<int> twin_of(count, none);
    for (int v = 0; v < count; ++v) {
        const Point& p = seam.surface.point(v);
        const auto [at, fresh] = first.emplace(std::array{p.x(), p.y(), p.z()}, v);
        if (!fresh) {
            twin_of[v] = at->second;
            twin_of[at->second] = v;
        }
    }
    const auto above = [&](int v) {
        double sum = 0;
        for (int h = 0; h < seam.surface.halfedge_count(); ++h)
            if (seam.surface.origin(h) == v)
                for (int w : seam.surface.face(h / 3)) sum += seam.surface.point(w).y() - seam.surface.point(v).y();
        return sum > 0;
    };
    seam.right.resize(count);
    seam.border.other_side.assign(count, none);
    for (int v = 0; v < count; ++v) {
        seam.right[v] = twin_of[v] != none && above(v) ? twin_of[v] : v;
        const int h = seam.surface.outgoing(v);
        if (twin_of[v] != none && seam.surface.twin(h) == none && twin_of[seam.surface.target(h)] != none)
            seam.border.other_side[v] = twin_of[seam.surface.target(h)];
    }
    return seam;
}

TEST(BorderPoints, TheTwoSidesOfAPoissonCurveShareTheirPoints) {
    const Seam seam = seam_strip();
    const int count = seam.surface.vertex_count();
    IntrinsicTriangulation t = intrinsic_triangulation(seam.surface);
    const std::vector<BorderPoint> points = insert_border_points(t, seam.surface, seam.border);
    int pairs = 0;
    for (const BorderPoint& p : points) {
        if (p.other == none)
            continue;
        ++pairs;
        const BorderPoint& q = points[p.other];
        EXPECT_EQ(&points[q.other], &p);
        EXPECT_NEAR(p.share + q.share, 1, 1e-12);
        EXPECT_TRUE(seam.surface.point(p.from) == seam.surface.point(q.to));
    }
    EXPECT_GT(pairs, 0);
    const Matrix S = surface_stiffness(seam.surface, seam.border);
    expect_laplacian(S);
    std::vector<Eigen::Triplet<double>> merge;
    for (int v = 0; v < count; ++v) merge.emplace_back(v, seam.right[v], 1.0);
    Matrix T(count, count);
    T.setFromTriplets(merge.begin(), merge.end());
    const Matrix merged = T.transpose() * S * T;
    // Without the points, merged weights are negative too.
    IntrinsicTriangulation plain = intrinsic_triangulation(seam.surface);
    make_delaunay(plain);
    EXPECT_GT(worst_weight(Matrix(T.transpose() * cotan_stiffness(plain, count) * T)), 1e-3);
    EXPECT_LE(worst_weight(merged), 1e-8) << "rounding of sums whose parts have both signs";

    // u = x below, 3 x + 1 above: jump 1 + 2 x, no flux through the curve. And y without a jump: what leaves one side enters the
    // other.
    std::vector<char> upper(count, 0);
    for (int v = 0; v < count; ++v) upper[v] = seam.right[v] != v || seam.surface.point(v).y() > 0.03 + 1e-9;
    Eigen::VectorXd u(count), y(count);
    for (int v = 0; v < count; ++v) {
        const double x = seam.surface.point(v).x();
        u[v] = upper[v] ? 3 * x + 1 : x;
        y[v] = seam.surface.point(v).y();
    }
    const Eigen::VectorXd jump_force = T.transpose() * (S * u), y_force = T.transpose() * (S * y);
    for (int v = 0; v < count; ++v) {
        const Point& p = seam.surface.point(v);
        if (p.x() > 0 && p.x() < 1) {
            EXPECT_NEAR(jump_force[v], 0, 1e-10 * largest(S)) << v;
        }
        if (p.x() > 0.1 && p.x() < 0.9 && p.y() > 0.02 && p.y() < 0.04) {
            EXPECT_NEAR(y_force[v], 0, 1e-10 * largest(S)) << v;
        }
    }
}

TEST(BorderPoints, SmallAnglesAndNarrowChannelsComeToAnEnd) {
    // A fan of needles: every side of the wedge sees the other's vertices at obtuse angles; steps differ by thousands.
    for (double angle : {0.5, 0.05, 0.001}) {
        std::vector<Point> points{{0, 0, 0}};
        std::vector<Face> faces;
        const int steps = 30;
        for (int i = 1; i <= steps; ++i) {
            const double r = std::pow(1.4, i), s = std::pow(1.33, i) * 1.1;
            points.emplace_back(r, 0, 0);
            points.emplace_back(s * std::cos(angle), s * std::sin(angle), 0);
        }
        faces.push_back({0, 1, 2});
        for (int i = 1; i < steps; ++i) {
            const int a = 2 * i - 1, b = 2 * i, c = 2 * i + 1, d = 2 * i + 2;
            faces.push_back({a, c, b});
            faces.push_back({b, c, d});
        }
        const Surface wedge(points, faces);
        IntrinsicTriangulation t = intrinsic_triangulation(wedge);
        const std::size_t inserted = insert_border_points(t, wedge, {}).size();
        EXPECT_GT(inserted, 0u);
        EXPECT_LT(inserted, 2u * 2 * steps);
        const Matrix S = surface_stiffness(wedge, {});
        EXPECT_LE(worst_weight(S), 0) << angle;
    }
}

TEST(BorderPoints, NumberingRotationAndScaleChangeNothing) {
    const Surface surface =
        fixtures::lifted(slivers(12, 0.07), [](double x, double y) { return 0.1 * std::sin(5 * x + 40 * y); });
    const Eigen::MatrixXd S = surface_stiffness(surface, {});
    const fixtures::Permuted other = fixtures::permuted(fixtures::scaled(fixtures::rotated(surface, 0.8), 1e4), 6);
    const Eigen::MatrixXd R = surface_stiffness(other.surface, {});
    double worst = 0;
    for (int i = 0; i < S.rows(); ++i)
        for (int j = 0; j < S.cols(); ++j) worst = std::max(worst, std::abs(S(i, j) - R(other.vertex[i], other.vertex[j])));
    EXPECT_LT(worst, 1e-8 * S.cwiseAbs().maxCoeff());
}

TEST(BorderPoints, ClosedSurfacesHaveNone) {
    const Surface sphere = fixtures::icosphere(4);
    IntrinsicTriangulation t = intrinsic_triangulation(sphere);
    EXPECT_TRUE(insert_border_points(t, sphere, {}).empty());
    EXPECT_LE(worst_weight(surface_stiffness(sphere, {})), 0);
}

}  // namespace
}  // namespace pvg
