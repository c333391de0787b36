// The patches' stiffness on whole domains: no negative weight, and the oracle's own operator gives the same solution.
#include <cstdio>
#include <vector>

#include <gtest/gtest.h>

#include "fixtures/domains.h"
#include "fixtures/fem.h"
#include "solve/bad_domains.h"
#include "solve/patch_space.h"

namespace pvg {
namespace {

using fixtures::bad_domains;
using Matrix = Eigen::SparseMatrix<double>;

/// One unknown for both copies on a sharp Poisson curve.
Matrix merged(const Domain& domain, const Matrix& S) {
    std::vector<int> to(domain.surface.vertex_count());
    for (std::size_t v = 0; v < to.size(); ++v) to[v] = static_cast<int>(v);
    for (const Coupling& c : domain.couplings) to[c.left] = c.right;
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t v = 0; v < to.size(); ++v) entries.emplace_back(static_cast<int>(v), to[v], 1.0);
    Matrix T(S.rows(), S.cols());
    T.setFromTriplets(entries.begin(), entries.end());
    return T.transpose() * S * T;
}

/// Pairs of vertices whose weight is negative, those between two fixed ones (which act on nothing) counted apart.
struct Negative {
    int acting = 0, idle = 0;
    double worst = 0;
};

Negative negative_weights(const Domain& domain, const Matrix& S) {
    Negative result;
    for (int column = 0; column < S.outerSize(); ++column)
        for (Matrix::InnerIterator it(S, column); it; ++it)
            if (it.row() < column && it.value() > 1e-8) {
                ++(domain.dirichlet[it.row()] && domain.dirichlet[column] ? result.idle : result.acting);
                result.worst = std::max(result.worst, it.value());
            }
    return result;
}

TEST(Stiffness, HasNoNegativeWeight) {
    int acting = 0;
    for (const auto& [name, domain] : bad_domains()) {
        IntrinsicTriangulation plain = intrinsic_triangulation(domain.surface);
        make_delaunay(plain);
        const int vertices = domain.surface.vertex_count();
        const Negative before = negative_weights(domain, merged(domain, cotan_stiffness(plain, vertices)));
        const std::size_t points = insert_border_points(plain, domain.surface, border_conditions(domain)).size();
        const Negative after =
            negative_weights(domain, merged(domain, surface_stiffness(domain.surface, border_conditions(domain))));
        std::printf("%-36s %5d vertices: %3d + %3d between fixed ones (worst %.2g) -> %d + %d, %zu points\n", name, vertices,
                    before.acting, before.idle, before.worst, after.acting, after.idle, points);
        EXPECT_EQ(after.acting + after.idle, 0) << name;
        acting += before.acting;
    }
    EXPECT_GT(acting, 50) << "the fixtures are too good to show anything";
}

TEST(Stiffness, TheOracleAgrees) {
    for (const auto& [name, domain] : bad_domains()) {
        const Matrix S = surface_stiffness(domain.surface, border_conditions(domain));
        const Eigen::VectorXd u = fixtures::fem_solution(domain, S);
        const Eigen::VectorXd truth = solve_finite_elements(fixtures::fem_problem(domain)).col(0);
        const double range = truth.maxCoeff() - truth.minCoeff(), worst = (u - truth).cwiseAbs().maxCoeff();
        std::printf("%-36s agree to %.1e of the range\n", name, worst / range);
        EXPECT_LT(worst, 1e-8 * range) << name;
    }
}

TEST(Stiffness, TheOraclesEnergyAgrees) {
    // Without sources the truth's energy is known from the same matrix; errors are 0 where values are given.
    for (auto& [name, domain] : bad_domains()) {
        const Matrix S = surface_stiffness(domain.surface, border_conditions(domain));
        const FemProblem problem = fixtures::fem_problem(domain);
        Eigen::VectorXd e(S.rows()), d(S.rows());
        for (Eigen::Index v = 0; v < e.size(); ++v) {
            const bool free = !domain.dirichlet[static_cast<std::size_t>(v)];
            e[v] = free ? std::sin(0.37 * static_cast<double>(v)) : 0;
            d[v] = free ? std::cos(0.21 * static_cast<double>(v)) : 0;
        }
        for (const Coupling& c : domain.couplings) {
            e[c.left] = e[c.right];
            d[c.left] = d[c.right];
        }
        const double ratio = compare_fields(problem, d, d + e)[0].h1;
        EXPECT_NEAR(ratio, 100 * std::sqrt(e.dot(S * e) / d.dot(S * d)), 1e-7 * ratio) << name;
    }
}

TEST(Stiffness, SolutionsWithoutSourcesStayBetweenTheirValues) {
    for (auto& [name, domain] : bad_domains()) {
        domain.sources.clear();
        for (Coupling& c : domain.couplings) c.jump.setZero();
        const Eigen::VectorXd u = fixtures::fem_solution(domain, surface_stiffness(domain.surface, border_conditions(domain)));
        double low = 1e300, high = -1e300;
        for (int v = 0; v < u.size(); ++v)
            if (domain.dirichlet[v]) {
                low = std::min(low, domain.dirichlet_value(v, 0));
                high = std::max(high, domain.dirichlet_value(v, 0));
            }
        EXPECT_GE(u.minCoeff(), low - 1e-12) << name;
        EXPECT_LE(u.maxCoeff(), high + 1e-12) << name;
    }
}

}  // namespace
}  // namespace pvg
