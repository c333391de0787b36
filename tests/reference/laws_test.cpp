// Laws of the finite-element oracle, of its triangulation, and of the errors it reports.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <Eigen/Geometry>

#include "cpu_reference/border_refinement.h"
#include "reference/polar_mesh.h"

namespace pvg {
namespace {

using test::polar_mesh;
using test::PolarMesh;
using test::row;

/// A unit square of n x n cells, its inner vertices shaken (up to 0.5: no triangle turns over), each cell flattened by `flat` in
/// y.
FemProblem shaken_square(int n, double shake, double flat, std::uint32_t seed) {
    std::mt19937 random(seed);
    const auto unit = [&] { return static_cast<double>(random() >> 8) / 16777216.0 - 0.5; };
    FemProblem problem;
    for (int j = 0; j <= n; ++j) {
        for (int i = 0; i <= n; ++i) {
            const bool inside = i > 0 && i < n && j > 0 && j < n;
            problem.points.emplace_back((i + (inside ? shake * unit() : 0)) / n, flat * (j + (inside ? shake * unit() : 0)) / n,
                                        0);
        }
    }
    for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) {
            const int a = j * (n + 1) + i, b = a + 1, d = a + n + 1, c = d + 1;
            problem.faces.push_back({a, b, c});
            problem.faces.push_back({a, c, d});
        }
    }
    return problem;
}

void fix_border(FemProblem& problem, int n, const std::function<double(const Eigen::Vector3d&)>& u) {
    for (int j = 0; j <= n; ++j) {
        for (int i = 0; i <= n; ++i) {
            const int v = j * (n + 1) + i;
            if (i == 0 || i == n || j == 0 || j == n)
                problem.dirichlet.emplace_back(v, row(u(problem.points[v])));
        }
    }
}

TEST(FiniteElements, LinearPrecisionOnAnyTriangulation) {
    const auto linear = [](const Eigen::Vector3d& p) { return 0.3 + 2 * p.x() - 5 * p.y(); };
    for (auto triangulation : {FemTriangulation::intrinsic_delaunay, FemTriangulation::as_given}) {
        FemProblem problem = shaken_square(14, 0.5, 0.2, 1);
        fix_border(problem, 14, linear);
        const Eigen::MatrixXd u = solve_finite_elements(problem, triangulation);
        for (std::size_t v = 0; v < problem.points.size(); ++v) {
            EXPECT_NEAR(u(static_cast<Eigen::Index>(v), 0), linear(problem.points[v]), 1e-11);  // rounding of a direct solve
        }
    }
}

TEST(FiniteElements, BoundedByItsBorderWithoutSources) {
    // Slivers twenty times as long as high: their own cotangents are negative, and the bound would not hold on them.
    std::mt19937 random(5);
    FemProblem problem = shaken_square(16, 0.5, 0.05, 2);
    fix_border(problem, 16, [&](const Eigen::Vector3d&) { return double(random() % 2); });
    const Eigen::MatrixXd u = solve_finite_elements(problem);
    EXPECT_GE(u.minCoeff(), -1e-12);
    EXPECT_LE(u.maxCoeff(), 1 + 1e-12);
}

TEST(FiniteElements, BoundedWithAFreeBorderToo) {
    // The same slivers held in a few places only: border sides face obtuse angles, and get vertices of their own.
    FemProblem problem = shaken_square(16, 0.5, 0.05, 2);
    for (auto& point : problem.points) point.x() += 8 * point.y();
    for (int v : {0, 5, 40, 41, 150, 151, 152, 200, 288}) problem.dirichlet.emplace_back(v, row(v % 2));
    const Eigen::MatrixXd u = solve_finite_elements(problem);
    EXPECT_GE(u.minCoeff(), -1e-12);
    EXPECT_LE(u.maxCoeff(), 1 + 1e-12);
    const Eigen::MatrixXd given = solve_finite_elements(problem, FemTriangulation::as_given);
    EXPECT_TRUE(given.minCoeff() < -1e-3 || given.maxCoeff() > 1 + 1e-3) << "the fixture is too good to show anything";
    // Energies are those of the finer triangles: an error that is the solution itself is 100 %.
    EXPECT_NEAR(compare_fields(problem, u, 2 * u)[0].h1, 100, 1e-9);
}

TEST(BorderRefinement, ObtuseTriangleByHand) {
    LengthMesh mesh = make_length_mesh({{0, 0, 0}, {4, 0, 0}, {1, 1, 0}}, {{0, 1, 2}});
    const std::vector<AddedVertex> added = refine_border(mesh, {{}, {false, false, false}});
    ASSERT_EQ(added.size(), 1u);
    EXPECT_EQ(added[0].from, 0);
    EXPECT_EQ(added[0].to, 1);
    EXPECT_NEAR(added[0].at, 0.25, 1e-14);
    ASSERT_EQ(mesh.vertices.size(), 2u);
    double area = 0;
    for (const auto& l : mesh.lengths) {
        const double s = (l[0] + l[1] + l[2]) / 2;
        area += std::sqrt(s * (s - l[0]) * (s - l[1]) * (s - l[2]));
    }
    EXPECT_NEAR(area, 2, 1e-12);
    FemProblem problem;
    problem.points = {{0, 0, 0}, {4, 0, 0}, {1, 1, 0}};
    problem.faces = {{0, 1, 2}};
    problem.dirichlet = {{0, row(0)}, {2, row(1)}};
    // Vertex 1: weights 1/8 to the corner and 1/32 to vertex 0.
    EXPECT_NEAR(solve_finite_elements(problem)(1, 0), 0.8, 1e-13);
    mesh = make_length_mesh({{0, 0, 0}, {4, 0, 0}, {1, 1, 0}}, {{0, 1, 2}});
    EXPECT_TRUE(refine_border(mesh, {{}, {true, true, false}}).empty()) << "between held ends the value is linear";
}

TEST(FiniteElements, RotationPermutationAndScaleChangeNothing) {
    FemProblem problem = shaken_square(10, 0.5, 0.5, 3);
    fix_border(problem, 10, [](const Eigen::Vector3d& p) { return std::sin(7 * p.x()) + p.y(); });
    problem.laplacian = Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(problem.faces.size()), 1, 2.0);
    const Eigen::MatrixXd u = solve_finite_elements(problem);

    std::vector<int> to(problem.points.size());
    for (std::size_t v = 0; v < to.size(); ++v) to[v] = static_cast<int>((v * 37 + 11) % to.size());  // 121 and 37 are coprime
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -1).normalized()));
    const double scale = 40;
    FemProblem other;
    other.points.resize(problem.points.size());
    for (std::size_t v = 0; v < to.size(); ++v)
        other.points[to[v]] = scale * (turn * problem.points[v]) + Eigen::Vector3d(3, 1, 2);
    for (auto face = problem.faces.rbegin(); face != problem.faces.rend(); ++face) {
        other.faces.push_back({to[(*face)[1]], to[(*face)[2]], to[(*face)[0]]});
    }
    for (const auto& [v, value] : problem.dirichlet) other.dirichlet.emplace_back(to[v], value);
    other.laplacian = problem.laplacian / (scale * scale);
    const Eigen::MatrixXd w = solve_finite_elements(other);
    for (std::size_t v = 0; v < to.size(); ++v) {
        EXPECT_NEAR(u(static_cast<Eigen::Index>(v), 0), w(to[v], 0), 1e-11);  // rounding of a direct solve
    }
}

TEST(FiniteElements, ComponentsWithoutDirichletAreZero) {
    PolarMesh mesh = polar_mesh(test::steps(0, 1, 4), 12, true, test::in_the_plane);
    FemProblem problem = mesh.problem;
    const int first = static_cast<int>(problem.points.size());
    for (const auto& point : mesh.problem.points) problem.points.push_back(point + Eigen::Vector3d(5, 0, 0));
    for (const auto& face : mesh.problem.faces) problem.faces.push_back({face[0] + first, face[1] + first, face[2] + first});
    problem.laplacian = Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(problem.faces.size()), 1, 1.0);
    problem.dirichlet.emplace_back(0, row(3));
    problem.points.emplace_back(9, 9, 9);  // no face at all
    const Eigen::MatrixXd u = solve_finite_elements(problem);
    EXPECT_EQ(u.bottomRows(first + 1).cwiseAbs().maxCoeff(), 0);
    EXPECT_EQ(u(0, 0), 3);
    EXPECT_NE(u(1, 0), 0);

    // A jump carries the value over to the other component.
    problem.laplacian.setZero();
    problem.jumps.push_back({first, 0, row(0.5)});
    const Eigen::MatrixXd w = solve_finite_elements(problem);
    for (int v = 0; v < first; ++v) {
        EXPECT_NEAR(w(v, 0), 3, 1e-12);
        EXPECT_NEAR(w(first + v, 0), 3.5, 1e-12);
    }
    EXPECT_EQ(w(2 * first, 0), 0);
}

TEST(FiniteElements, SeveralLeftsShareOneRight) {
    // Three strips meet at one edge's two vertices; two of them hang on the third by jumps, one of them through the other.
    FemProblem problem;
    for (double angle : {0.0, 2.0, 4.0}) {
        for (double r : {0.0, 1.0, 2.0}) {
            for (double z : {0.0, 1.0}) problem.points.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
        }
    }
    for (int strip : {0, 6, 12}) {
        for (int step : {0, 2}) {
            const int a = strip + step;
            problem.faces.push_back({a, a + 2, a + 3});
            problem.faces.push_back({a, a + 3, a + 1});
        }
        for (int z : {0, 1}) problem.dirichlet.emplace_back(strip + 4 + z, row(strip));
    }
    for (int z : {0, 1}) {
        problem.jumps.push_back({6 + z, z, row(1)});
        problem.jumps.push_back({12 + z, z, row(2)});
        problem.jumps.push_back({12 + z, 6 + z, row(1)});  // says the same again
    }
    const Eigen::MatrixXd u = solve_finite_elements(problem);
    // Ends 0, 6, 12 at distance 2: the middle m balances (m - 0) + (m + 1 - 6) + (m + 2 - 12) = 0.
    EXPECT_NEAR(u(0, 0), 5, 1e-12);
    EXPECT_NEAR(u(6, 0), 6, 1e-12);
    EXPECT_NEAR(u(12, 0), 7, 1e-12);
    EXPECT_NEAR(u(8, 0), 6, 1e-12);
    // A vertex that is fixed itself keeps its value; what a jump ties to it follows.
    problem.dirichlet.emplace_back(6, row(100));
    const Eigen::MatrixXd w = solve_finite_elements(problem);
    EXPECT_EQ(w(6, 0), 100);
    EXPECT_NEAR(w(0, 0), 99, 1e-12);
    EXPECT_NEAR(w(12, 0), 101, 1e-12);
}

TEST(FiniteElements, WrongInputIsAnError) {
    FemProblem problem = shaken_square(2, 0, 1, 1);
    problem.dirichlet.emplace_back(99, row(1));
    EXPECT_THROW(solve_finite_elements(problem), std::runtime_error);
    problem.dirichlet = {{0, row(1)}};
    problem.laplacian = Eigen::MatrixXd::Zero(3, 1);
    EXPECT_THROW(solve_finite_elements(problem), std::runtime_error);
    problem.laplacian.resize(0, 0);
    EXPECT_NO_THROW(solve_finite_elements(problem));
    EXPECT_THROW(compare_fields(problem, Eigen::MatrixXd::Zero(9, 1), Eigen::MatrixXd::Zero(8, 1)), std::runtime_error);
}

TEST(DelaunayFlips, KeepTheSurfaceAndEndDelaunay) {
    FemProblem problem = shaken_square(20, 0.5, 0.04, 4);
    for (auto& point : problem.points) point = {point.x(), point.y(), 0.3 * std::sin(5 * point.x()) * std::cos(90 * point.y())};
    LengthMesh mesh = make_length_mesh(problem.points, problem.faces);
    const auto area = [&] {
        double sum = 0;
        for (const auto& l : mesh.lengths) {
            const double s = (l[0] + l[1] + l[2]) / 2;
            sum += std::sqrt(std::max(0.0, s * (s - l[0]) * (s - l[1]) * (s - l[2])));
        }
        return sum;
    };
    const double before = area();
    EXPECT_GT(flip_to_delaunay(mesh), 50u);
    EXPECT_NEAR(area(), before, 1e-10 * before);  // thousands of roundings
    for (std::size_t f = 0; f < mesh.vertices.size(); ++f) {
        for (int k = 0; k < 3; ++k) {
            const int twin = mesh.twins[f][k];
            if (twin < 0)
                continue;
            EXPECT_EQ(mesh.twins[twin / 3][twin % 3], static_cast<int>(3 * f) + k);
            EXPECT_NEAR(mesh.lengths[f][k], mesh.lengths[twin / 3][twin % 3], 1e-13);
            EXPECT_EQ(mesh.vertices[f][k], mesh.vertices[twin / 3][(twin % 3 + 1) % 3]);
            if (twin / 3 == static_cast<int>(f))
                continue;
            EXPECT_GT(opposite_cotangent(mesh.lengths[f], k) + opposite_cotangent(mesh.lengths[twin / 3], twin % 3), -2e-9);
        }
    }
}

TEST(DelaunayFlips, SliversDoNotSpoilTheOracle) {
    // exp(x) sin(y) on slivers: the error on flipped edges stays below the one on the given triangles.
    const auto u = [](const Eigen::Vector3d& p) { return std::exp(3 * p.x()) * std::sin(3 * p.y()); };
    FemProblem problem = shaken_square(24, 0.5, 0.1, 6);
    for (auto& point : problem.points) point.x() += 6 * point.y();  // shears every triangle
    fix_border(problem, 24, u);
    const auto error = [&](FemTriangulation triangulation) {
        Eigen::MatrixXd exact(static_cast<Eigen::Index>(problem.points.size()), 1);
        for (std::size_t v = 0; v < problem.points.size(); ++v) exact(static_cast<Eigen::Index>(v), 0) = u(problem.points[v]);
        return compare_fields(problem, exact, solve_finite_elements(problem, triangulation))[0];
    };
    const FieldError flipped = error(FemTriangulation::intrinsic_delaunay), given = error(FemTriangulation::as_given);
    EXPECT_LT(flipped.max, 0.5 * given.max);
    EXPECT_LT(flipped.mean, 0.5 * given.mean);
}

TEST(CompareFields, MeasuresWhatItSays) {
    FemProblem problem = shaken_square(10, 0, 1, 1);
    problem.dirichlet.emplace_back(0, row(0));
    const auto count = static_cast<Eigen::Index>(problem.points.size());
    Eigen::MatrixXd truth(count, 2), values;
    for (Eigen::Index v = 0; v < count; ++v) truth.row(v) << 4 * problem.points[v].x() - 1, 7;
    values = truth;
    problem.dirichlet[0].second = Eigen::RowVectorXd::Zero(2);
    for (const FieldError& error : compare_fields(problem, truth, values)) {
        EXPECT_EQ(error.mean, 0);
        EXPECT_EQ(error.max, 0);
        EXPECT_EQ(error.h1, 0);
    }
    values.col(0) = 1.1 * truth.col(0);  // e = 0.1 u
    std::vector<FieldError> errors = compare_fields(problem, truth, values);
    EXPECT_NEAR(errors[0].h1, 10, 1e-9);
    EXPECT_NEAR(errors[0].max, 100 * 0.3 / 4, 1e-9);  // |u| reaches 3, its range is 4
    values.col(0) = truth.col(0).array() + 0.02;
    values(5, 1) += 1;
    errors = compare_fields(problem, truth, values);
    EXPECT_NEAR(errors[0].mean, 0.5, 1e-9);
    EXPECT_NEAR(errors[0].max, 0.5, 1e-9);
    EXPECT_NEAR(errors[0].h1, 0, 1e-5);           // a constant has no energy
    EXPECT_NEAR(errors[1].max, 100.0 / 7, 1e-9);  // a constant is measured by its magnitude
    values(6, 0) = std::numeric_limits<double>::quiet_NaN();
    errors = compare_fields(problem, truth, values);
    EXPECT_TRUE(std::isnan(errors[0].mean) && std::isnan(errors[0].max) && std::isnan(errors[0].h1));

    // Vertices that nothing reaches do not count, whatever stands there.
    problem.points.emplace_back(9, 9, 9);
    Eigen::MatrixXd longer = truth, wrong = truth;
    longer.conservativeResize(count + 1, 2);
    wrong.conservativeResize(count + 1, 2);
    longer.row(count).setZero();
    wrong.row(count).setConstant(std::numeric_limits<double>::quiet_NaN());
    EXPECT_EQ(compare_fields(problem, longer, wrong)[0].max, 0);
}

TEST(CompareFields, ConstantsAreMeasuredByTheirMagnitude) {
    FemProblem problem = shaken_square(10, 0.4, 1, 3);
    problem.dirichlet.emplace_back(0, Eigen::RowVectorXd::Zero(3));
    problem.points.emplace_back(9, 9, 9);  // unreached: its 0 makes no range
    const auto count = static_cast<Eigen::Index>(problem.points.size());
    Eigen::MatrixXd truth(count, 3);
    for (Eigen::Index v = 0; v < count; ++v)
        truth.row(v) << 5 * (1 + 1e-14 * static_cast<double>(v % 7)), 2 + 1e-6 * problem.points[v].x(), 0;
    truth.row(count - 1).setZero();
    const Eigen::RowVectorXd scale = error_scale(problem, truth);
    EXPECT_NEAR(scale[0], 5, 1e-9);
    EXPECT_NEAR(scale[1], 1e-6, 1e-14);  // small, but no rounding
    EXPECT_EQ(scale[2], 0);

    // Values in single precision are off by up to 6e-8 of the magnitude.
    Eigen::MatrixXd values = truth;
    for (Eigen::Index v = 0; v + 1 < count; ++v) values(v, 0) += (v % 2 ? 5 : -5) * 6e-8;
    std::vector<FieldError> errors = compare_fields(problem, truth, values);
    EXPECT_NEAR(errors[0].mean, 6e-6, 1e-9);
    EXPECT_NEAR(errors[0].max, 6e-6, 1e-9);
    EXPECT_LT(errors[0].h1, 1e-5);
    values(5, 0) += 0.5;  // a real error shows
    values(5, 1) += 5e-7;
    values(5, 2) += 1e-20;
    errors = compare_fields(problem, truth, values);
    EXPECT_NEAR(errors[0].max, 10, 1e-4);
    EXPECT_GT(errors[0].h1, 0.5);  // one vertex of 121: 10 % / 11
    EXPECT_NEAR(errors[1].max, 50, 1e-6);
    EXPECT_TRUE(std::isinf(errors[2].mean) && std::isinf(errors[2].max) && std::isinf(errors[2].h1));
}

TEST(CompareFields, MeanIsWeightedByArea) {
    PolarMesh mesh = polar_mesh(test::steps(0, 1, 10), 24, true, test::in_the_plane);
    mesh.problem.dirichlet.emplace_back(0, row(0));
    const Eigen::MatrixXd truth = test::sampled(mesh, [](double r, double) { return r; });
    Eigen::MatrixXd values = truth;
    for (std::size_t v = 0; v < mesh.radius.size(); ++v) {
        if (mesh.radius[v] < 0.55)
            values(static_cast<Eigen::Index>(v), 0) += 0.01;
    }
    // The disk r < 0.55 is 30.25 % of the area, though it holds half of the vertices; lumping blurs its edge.
    EXPECT_NEAR(compare_fields(mesh.problem, truth, values)[0].mean, 0.3025, 0.005);
}

}  // namespace
}  // namespace pvg
