// Laws of the intrinsic Delaunay triangulation and its stiffness.
#include <cmath>
#include <random>

#include <Eigen/SparseCholesky>
#include <gtest/gtest.h>

#include "mesh/intrinsic.h"

namespace pvg {
namespace {

/// n x n quads over the unit square, squeezed in y so that triangles are slivers, interior vertices jittered. Lifted onto a
/// paraboloid by `lift`.
Surface sliver_grid(int n, double squeeze, double lift, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> jitter(-0.24, 0.24);  // farther could fold a triangle over
    std::vector<Point> points;
    std::vector<Face> faces;
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) {
            const bool inside = i > 0 && j > 0 && i < n && j < n;
            const double x = (i + (inside ? jitter(random) : 0)) / n, y = squeeze * (j + (inside ? jitter(random) : 0)) / n;
            points.emplace_back(x, y, lift * (x * x + y * y));
        }
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const int a = j * (n + 1) + i, b = a + 1, c = a + n + 2, d = a + n + 1;
            faces.push_back({a, b, c});
            faces.push_back({a, c, d});
        }
    return Surface(points, faces);
}

/// A closed surface with few long triangles: flips here make edges that join a vertex to itself.
Surface long_tetrahedron() {
    return Surface({{0, 0, 0}, {1, 0, 0}, {0.5, 0.02, 0}, {0.5, 0.01, 0.01}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}});
}

double total(const Eigen::VectorXd& values) { return values.sum(); }

double smallest_weight(const Eigen::SparseMatrix<double>& S, const Surface& surface) {
    double least = 0;
    for (int column = 0; column < S.outerSize(); ++column)
        for (Eigen::SparseMatrix<double>::InnerIterator entry(S, column); entry; ++entry)
            if (entry.row() != column &&
                !(surface.is_border_vertex(column) && surface.is_border_vertex(static_cast<int>(entry.row()))))
                least = std::min(least, -entry.value());
    return least;
}

void expect_consistent(const IntrinsicTriangulation& t) {
    for (int h = 0; h < static_cast<int>(t.twin.size()); ++h) {
        const int w = t.twin[h];
        if (w == none)
            continue;
        ASSERT_EQ(t.twin[w], h);
        EXPECT_EQ(t.faces[h / 3][h % 3], t.faces[w / 3][(w + 1) % 3 == 0 ? w % 3 - 2 : w % 3 + 1]);
        EXPECT_EQ(t.lengths[h / 3][h % 3], t.lengths[w / 3][w % 3]);
    }
}

TEST(Intrinsic, FlipsEndWithNonNegativeInteriorWeights) {
    for (double squeeze : {1.0, 0.1, 0.003})
        for (double lift : {0.0, 1.0}) {
            const Surface surface = sliver_grid(24, squeeze, lift, 7);
            IntrinsicTriangulation t = intrinsic_triangulation(surface);
            EXPECT_GT(make_delaunay(t), 0);
            EXPECT_EQ(make_delaunay(t), 0) << "a second pass finds nothing to flip";
            expect_consistent(t);
            // Rounding: weights are quotients of a sum within 1e-13 of zero.
            EXPECT_GE(smallest_weight(cotan_stiffness(t, surface.vertex_count()), surface), -1e-9);
        }
}

TEST(Intrinsic, FlipsKeepArea) {
    const Surface surface = sliver_grid(24, 0.02, 1, 3);
    IntrinsicTriangulation t = intrinsic_triangulation(surface);
    EXPECT_NEAR(total(lumped_areas(t, surface.vertex_count())), surface.area(), 1e-12);
    make_delaunay(t);
    EXPECT_NEAR(total(lumped_areas(t, surface.vertex_count())), surface.area(), 1e-9 * surface.area());
}

TEST(Intrinsic, StiffnessKillsConstantsAndPlanarLinearFunctions) {
    const Surface surface = sliver_grid(20, 0.05, 0, 5);
    IntrinsicTriangulation t = intrinsic_triangulation(surface);
    make_delaunay(t);
    const auto S = cotan_stiffness(t, surface.vertex_count());
    Eigen::VectorXd one = Eigen::VectorXd::Ones(surface.vertex_count()), x = one, y = one;
    for (int v = 0; v < surface.vertex_count(); ++v) {
        x[v] = surface.point(v).x();
        y[v] = surface.point(v).y();
    }
    EXPECT_LT((S * one).cwiseAbs().maxCoeff(), 1e-9);
    const Eigen::VectorXd sx = S * x, sy = S * y;
    // Weights reach 1 / 0.05 here; their rounding times the unit square.
    for (int v = 0; v < surface.vertex_count(); ++v)
        if (!surface.is_border_vertex(v)) {
            EXPECT_NEAR(sx[v], 0, 1e-9);
            EXPECT_NEAR(sy[v], 0, 1e-9);
        }
    EXPECT_NEAR(x.dot(S * x), 0.05, 1e-9) << "the energy of x is the area";
}

TEST(Intrinsic, ScaleAndFaceOrderChangeNothing) {
    const Surface surface = sliver_grid(16, 0.1, 1, 9);
    IntrinsicTriangulation t = intrinsic_triangulation(surface);
    make_delaunay(t);
    const auto S = cotan_stiffness(t, surface.vertex_count());

    std::vector<Point> points = surface.points();
    for (Point& p : points) p *= 4096;
    std::vector<Face> faces(surface.faces().rbegin(), surface.faces().rend());
    for (Face& f : faces) f = {f[1], f[2], f[0]};
    IntrinsicTriangulation other = intrinsic_triangulation(Surface(points, faces));
    make_delaunay(other);
    const Eigen::SparseMatrix<double> D = cotan_stiffness(other, surface.vertex_count()) - S;
    EXPECT_LT(Eigen::MatrixXd(D).cwiseAbs().maxCoeff(), 1e-7);
}

TEST(Intrinsic, SameInputSameBits) {
    const Surface surface = sliver_grid(16, 0.1, 1, 11);
    IntrinsicTriangulation a = intrinsic_triangulation(surface), b = intrinsic_triangulation(surface);
    EXPECT_EQ(make_delaunay(a), make_delaunay(b));
    EXPECT_EQ(a.faces, b.faces);
    EXPECT_EQ(a.lengths, b.lengths);
    EXPECT_EQ(a.twin, b.twin);
}

TEST(Intrinsic, ClosedSurfaceWithEdgesFromAVertexToItself) {
    const Surface surface = long_tetrahedron();
    IntrinsicTriangulation t = intrinsic_triangulation(surface);
    make_delaunay(t);
    expect_consistent(t);
    const auto S = cotan_stiffness(t, 4);
    EXPECT_LT((S * Eigen::VectorXd::Ones(4)).cwiseAbs().maxCoeff(), 1e-9);
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) EXPECT_TRUE(i == j || S.coeff(i, j) <= 1e-9) << i << " - " << j;
    EXPECT_NEAR(total(lumped_areas(t, 4)), surface.area(), 1e-9 * surface.area());
}

TEST(Intrinsic, TrianglesWithoutAreaStayFinite) {
    // Vertex 4 lies on the edge 0 - 2: one face is a cap without area; the flip removes it.
    const Surface surface({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 0}},
                          {{0, 1, 2}, {0, 2, 4}, {0, 4, 3}, {4, 2, 3}});
    IntrinsicTriangulation t = intrinsic_triangulation(surface);
    make_delaunay(t);
    const auto S = cotan_stiffness(t, 5);
    EXPECT_TRUE(Eigen::MatrixXd(S).allFinite());
    for (int j = 0; j < 4; ++j) EXPECT_NEAR(S.coeff(4, j), -1, 1e-12) << "the four right triangles of the square";
}

TEST(Intrinsic, SolutionOnSliversIsAsGoodAsOnTheRegularGrid) {
    // Harmonic x^2 - y^2 with its own border values; the extrinsic slivers have angles up to 179 degrees.
    const double squeeze = 0.1;
    const Surface surface = sliver_grid(32, squeeze, 0, 13);
    IntrinsicTriangulation t = intrinsic_triangulation(surface);
    make_delaunay(t);
    const int n = surface.vertex_count();
    const auto S = cotan_stiffness(t, n);
    const auto exact = [&](int v) {
        return surface.point(v).x() * surface.point(v).x() - surface.point(v).y() * surface.point(v).y();
    };
    std::vector<int> unknown(n, none);
    int unknowns = 0;
    for (int v = 0; v < n; ++v)
        if (!surface.is_border_vertex(v))
            unknown[v] = unknowns++;
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns);
    for (int column = 0; column < n; ++column)
        for (Eigen::SparseMatrix<double>::InnerIterator e(S, column); e; ++e) {
            const int row = unknown[e.row()];
            if (row == none)
                continue;
            if (unknown[column] == none)
                right[row] -= e.value() * exact(column);
            else
                entries.emplace_back(row, unknown[column], e.value());
        }
    Eigen::SparseMatrix<double> inner(unknowns, unknowns);
    inner.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(inner);
    ASSERT_EQ(factor.info(), Eigen::Success);
    const Eigen::VectorXd u = factor.solve(right);
    double worst = 0;
    for (int v = 0; v < n; ++v)
        if (unknown[v] != none)
            worst = std::max(worst, std::abs(u[unknown[v]] - exact(v)));
    // Linear elements: interpolation error of order h^2 = 1e-3, of range 1.
    EXPECT_LT(worst, 1e-3);
}

}  // namespace
}  // namespace pvg
