// The finite-element oracle against solutions in closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "reference/polar_mesh.h"

namespace pvg {
namespace {

using test::polar_mesh;
using test::PolarMesh;
using test::row;
using Solution = std::function<double(double, double)>;

double largest_error(const PolarMesh& mesh, const Solution& u) {
    return (solve_finite_elements(mesh.problem) - test::sampled(mesh, u)).cwiseAbs().maxCoeff();
}

/// Largest errors at n and 2 n steps: their ratio is 4 for an error that falls with the square of the edge length.
void expect_second_order(const std::function<double(int)>& error, int n, double bound, double least_order = 1.75) {
    const double coarse = error(n), fine = error(2 * n);
    EXPECT_LT(coarse, bound);
    EXPECT_GT(std::log2(coarse / fine), least_order) << coarse << " " << fine;  // h^2 with a logarithm
}

TEST(AnalyticSolutions, BandOnASphere) {
    const double low = 0.4, high = 2.2;
    const Solution u = [&](double theta, double) {
        const double a = std::log(std::tan(low / 2)), b = std::log(std::tan(high / 2));
        return (std::log(std::tan(theta / 2)) - a) / (b - a);
    };
    expect_second_order(
        [&](int n) {
            PolarMesh mesh = polar_mesh(test::steps(low, high, n), 3 * n, true, test::on_the_unit_sphere);
            test::fix_ring(mesh, 0, u);
            test::fix_ring(mesh, n, u);
            return largest_error(mesh, u);
        },
        20, 2e-3);
}

TEST(AnalyticSolutions, HarmonicPolynomialsInADisk) {
    for (int degree : {2, 3, 5}) {
        const Solution u = [&](double r, double angle) { return std::pow(r, degree) * std::cos(degree * angle - 0.3); };
        expect_second_order(
            [&](int n) {
                PolarMesh mesh = polar_mesh(test::steps(0, 1, n), 6 * n, true, test::in_the_plane);
                test::fix_ring(mesh, n - 1, u);
                return largest_error(mesh, u);
            },
            12, 3e-2);
    }
}

TEST(AnalyticSolutions, DiskWithASource) {
    const double f = -3, R = 0.7;
    const Solution u = [&](double r, double) { return f * (r * r - R * R) / 4; };
    EXPECT_GT(u(0, 0), 0);  // f < 0 raises a bump
    expect_second_order(
        [&](int n) {
            PolarMesh mesh = polar_mesh(test::steps(0, R, n), 6 * n, true, test::in_the_plane);
            mesh.problem.laplacian = Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(mesh.problem.faces.size()), 1, f);
            test::fix_ring(mesh, n - 1, u);
            return largest_error(mesh, u);
        },
        12, 1e-2, 1.6);  // the fan of ever more slivers around the centre makes the logarithm felt
}

TEST(AnalyticSolutions, OpenSlit) {
    const Solution u = [](double r, double angle) { return std::sqrt(r) * std::sin(angle / 2); };
    // Rings graded towards the tip as r = (i / n)^4 bring back the second order that r^(1/2) costs on even rings. The slit is
    // natural or fixed: u meets both.
    for (bool fixed : {false, true}) {
        const auto error = [&](int n) {
            PolarMesh mesh = polar_mesh(test::steps(0, 1, n, 4), 6 * n, false, test::in_the_plane);
            test::fix_ring(mesh, n - 1, u);
            if (fixed) {
                for (int ring = 0; ring < n - 1; ++ring) {
                    for (int column : {0, mesh.columns - 1}) {
                        const int v = mesh.vertex(ring, column);
                        mesh.problem.dirichlet.emplace_back(v, row(u(mesh.radius[v], mesh.angle[v])));
                    }
                }
                mesh.problem.dirichlet.emplace_back(0, row(0));
            }
            return largest_error(mesh, u);
        };
        expect_second_order(error, 12, 1e-2);
    }
}

/// A disk cut along ring `cut` - 1: the outer part has its own copies of that ring's vertices.
struct CutDisk {
    PolarMesh inner, outer;
    FemProblem problem;  ///< inner's vertices, then outer's
    int outer_first = 0;
};

CutDisk cut_disk(int n, int cut) {
    const std::vector<double> radii = test::steps(0, 1, n);
    CutDisk disk;
    disk.inner = polar_mesh({radii.begin(), radii.begin() + cut + 1}, 6 * n, true, test::in_the_plane);
    disk.outer = polar_mesh({radii.begin() + cut, radii.end()}, 6 * n, true, test::in_the_plane);
    disk.problem = disk.inner.problem;
    disk.outer_first = static_cast<int>(disk.problem.points.size());
    for (const auto& point : disk.outer.problem.points) disk.problem.points.push_back(point);
    for (auto face : disk.outer.problem.faces) {
        for (int& v : face) v += disk.outer_first;
        disk.problem.faces.push_back(face);
    }
    return disk;
}

TEST(AnalyticSolutions, JumpAlongACircle) {
    // u = C r cos inside r = a, (A r + B / r) cos outside; u falls by J cos across the circle, its flux does not change.
    const double J = 0.8;
    expect_second_order(
        [&](int n) {
            const int cut = n / 2;
            CutDisk disk = cut_disk(n, cut);
            const double a = double(cut) / n, B = -J * a / 2, A = J * a / 2, C = A - B / (a * a);
            for (int k = 0; k < 6 * n; ++k) {
                const int in = disk.inner.vertex(cut - 1, k), out = disk.outer_first + disk.outer.vertex(0, k);
                disk.problem.jumps.push_back({in, out, row(J * std::cos(disk.inner.angle[in]))});
                disk.problem.dirichlet.emplace_back(disk.outer_first + disk.outer.vertex(n - cut, k), row(0));
            }
            const Eigen::MatrixXd u = solve_finite_elements(disk.problem);
            double error = 0;
            for (std::size_t v = 0; v < disk.problem.points.size(); ++v) {
                const bool inside = static_cast<int>(v) < disk.outer_first;
                const double r = disk.problem.points[v].norm(), x = disk.problem.points[v].x();
                const double exact = inside ? C * x : A * x + B * x / (r * r);
                error = std::max(error, std::abs(u(static_cast<Eigen::Index>(v), 0) - exact));
            }
            return error;
        },
        12, 1e-2);
}

TEST(AnalyticSolutions, ConstantJumpAroundACircleShiftsTheInside) {
    CutDisk disk = cut_disk(10, 4);
    for (int k = 0; k < 60; ++k) {
        disk.problem.jumps.push_back({disk.inner.vertex(3, k), disk.outer_first + disk.outer.vertex(0, k), row(2.5)});
        disk.problem.dirichlet.emplace_back(disk.outer_first + disk.outer.vertex(6, k), row(1));
    }
    const Eigen::MatrixXd u = solve_finite_elements(disk.problem);
    for (int v = 0; v < static_cast<int>(disk.problem.points.size()); ++v) {
        EXPECT_NEAR(u(v, 0), v < disk.outer_first ? 3.5 : 1, 1e-11);  // rounding of a direct solve
    }
}

}  // namespace
}  // namespace pvg
