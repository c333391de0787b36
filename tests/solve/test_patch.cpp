// The parts of a patch: envelope factor and log map.
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "fixtures/meshes.h"
#include "geodesic/geodesic.h"
#include "solve/envelope.h"
#include "solve/log_map.h"

namespace pvg {
namespace {

struct SmallSystem {
    Eigen::MatrixXd A;
    std::vector<int> first;
};

/// A random sparse diagonally dominant matrix.
SmallSystem random_system(int n, std::uint64_t seed) {
    fixtures::Random random(seed);
    SmallSystem system{Eigen::MatrixXd::Zero(n, n), std::vector<int>(n)};
    for (int i = 0; i < n; ++i) {
        system.first[i] = std::max(0, i - random.below(7));
        for (int j = system.first[i]; j < i; ++j) {
            const double w = random.below(2) ? random.real() : 0;
            system.A(i, j) = system.A(j, i) = -w;
            system.A(i, i) += w;
            system.A(j, j) += w;
        }
    }
    for (int i = 0; i < n; ++i) system.A(i, i) += 0.1;
    return system;
}

void fill(EnvelopeCholesky& factor, const SmallSystem& system) {
    factor.begin(system.first);
    for (int i = 0; i < static_cast<int>(system.first.size()); ++i)
        for (int j = system.first[i]; j <= i; ++j) factor.add(i, j, system.A(i, j));
}

TEST(Envelope, SolvesLikeADenseFactor) {
    EnvelopeCholesky factor;
    for (int n : {1, 5, 40}) {
        const SmallSystem system = random_system(n, 3 + n);
        fill(factor, system);
        ASSERT_EQ(factor.factor(), 0);
        RowMatrix X = RowMatrix::Random(n, 8);
        const Eigen::MatrixXd expected = system.A.llt().solve(Eigen::MatrixXd(X));
        factor.solve(X);
        EXPECT_LT((X - expected).cwiseAbs().maxCoeff(), 1e-12 * std::max(1.0, expected.cwiseAbs().maxCoeff()));
    }
}

TEST(Envelope, FixesAnUnknownWithoutAPivot) {
    // A graph Laplacian of two unknowns: singular. The second is held at 0, the first solves its own row.
    SmallSystem system{Eigen::MatrixXd::Zero(2, 2), {0, 0}};
    system.A << 2, -2, -2, 2;
    EnvelopeCholesky factor;
    fill(factor, system);
    EXPECT_EQ(factor.factor(), 1);
    RowMatrix X = RowMatrix::Constant(2, 4, 3);
    factor.solve(X);
    EXPECT_DOUBLE_EQ(X(1, 0), 0);
    EXPECT_NEAR(X(0, 0), 1.5, 1e-14);
}

std::vector<std::complex<double>> unfold_all(const Surface& surface, const std::vector<int>& partner, int centre,
                                             std::vector<int>& vertices) {
    vertices.resize(surface.vertex_count());
    std::iota(vertices.begin(), vertices.end(), 0);
    std::swap(vertices[0], vertices[centre]);
    std::vector<int> local(vertices.size());
    for (std::size_t v = 0; v < vertices.size(); ++v) local[vertices[v]] = static_cast<int>(v);
    std::vector<std::complex<double>> place;
    LogMap::Buffers buffers;
    LogMap(surface, partner).unfold(vertices, local, buffers, place);
    return place;
}

TEST(LogMap, IsExactInThePlane) {
    const Surface surface = fixtures::irregular_plane(12, 10);
    for (int centre : {0, 5, 60}) {  // a corner, a border vertex, an inner one
        std::vector<int> vertices;
        const auto place = unfold_all(surface, std::vector<int>(surface.vertex_count(), none), centre, vertices);
        const auto in_plane = [&](std::size_t v) {
            const Point p = surface.point(vertices[v]) - surface.point(centre);
            return std::complex<double>(p.x(), p.y());
        };
        const std::complex<double> turn = in_plane(7) / place[7];
        EXPECT_NEAR(std::abs(turn), 1, 1e-12);
        for (std::size_t v = 0; v < vertices.size(); ++v) EXPECT_NEAR(std::abs(turn * place[v] - in_plane(v)), 0, 1e-12);
    }
}

TEST(LogMap, CrossesAPoissonCurve) {
    // Two separate halves of a square whose copies along x = 0.5 are partners.
    const Surface left = fixtures::plane(4, 4, 0.5, 1);
    std::vector<Point> points = left.points();
    std::vector<Face> faces = left.faces();
    std::vector<int> partner(2 * points.size(), none);
    const int shift = left.vertex_count();
    for (int v = 0; v < shift; ++v) points.push_back(left.point(v) + Point(0.5, 0, 0));
    for (const Face& f : left.faces()) faces.push_back({f[0] + shift, f[1] + shift, f[2] + shift});
    for (int row = 0; row <= 4; ++row) {
        partner[row * 5 + 4] = shift + row * 5;
        partner[shift + row * 5] = row * 5 + 4;
    }
    const Surface both(points, faces);
    for (int centre : {11, 14}) {  // inside the left half, on the curve
        std::vector<int> vertices;
        const auto place = unfold_all(both, partner, centre, vertices);
        for (std::size_t v = 0; v < vertices.size(); ++v)
            EXPECT_NEAR(std::abs(place[v]), (both.point(vertices[v]) - both.point(centre)).norm(), 1e-12);
    }
}

TEST(LogMap, StaysCloseOnASphere) {
    const Surface sphere = fixtures::icosphere(16);
    std::vector<int> vertices;
    const auto place = unfold_all(sphere, std::vector<int>(sphere.vertex_count(), none), 100, vertices);
    for (std::size_t v = 1; v < vertices.size(); ++v) {
        const double distance = std::acos(std::min(1.0, sphere.point(vertices[v]).dot(sphere.point(100))));
        // Patches reach three knots' distances, 0.3 on this sphere; there the map need only be about right.
        if (distance > 0.5)
            continue;
        EXPECT_NEAR(std::abs(place[v]), distance, 0.05 * distance);
    }
}

TEST(LogMap, KeepsDistancesOnASaddle) {
    // The inside of a torus: curvature -4.2. Laying each face on an edge as that was laid itself scaled faces more and more:
    // distances were off by 11 % here, and on shaken vertices the map folded.
    const int around = 120, along = 60;
    const Surface torus = fixtures::torus(around, along);
    const int centre = 7 * along + along / 2;
    std::vector<int> all;
    const std::vector<GeodesicSource> source{{at_vertex(torus, centre)}};
    const std::vector<double> exact = geodesic_distances(torus, source).distance;
    for (int v = 0; v < torus.vertex_count(); ++v)
        if (exact[v] < 0.45)
            all.push_back(v);
    std::swap(*std::find(all.begin(), all.end(), centre), all[0]);
    std::vector<int> local(torus.vertex_count(), none);
    for (std::size_t i = 0; i < all.size(); ++i) local[all[i]] = static_cast<int>(i);
    std::vector<std::complex<double>> place;
    LogMap::Buffers buffers;
    LogMap(torus, std::vector<int>(torus.vertex_count(), none)).unfold(all, local, buffers, place);
    double worst = 0;
    int folded = 0;
    for (std::size_t i = 1; i < all.size(); ++i) worst = std::max(worst, std::abs(std::abs(place[i]) / exact[all[i]] - 1));
    for (const Face& f : torus.faces()) {
        if (local[f[0]] == none || local[f[1]] == none || local[f[2]] == none)
            continue;
        const std::complex<double> a = place[local[f[0]]];
        folded += std::imag((place[local[f[2]]] - a) * std::conj(place[local[f[1]]] - a)) <= 0;
    }
    EXPECT_GT(all.size(), 400u);
    EXPECT_LT(worst, 0.02);
    EXPECT_EQ(folded, 0);
}

}  // namespace
}  // namespace pvg
