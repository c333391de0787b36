// Energy-optimal coefficients: the condition itself, against a dense solution, and what must not change.
#include "solve/galerkin.h"

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "fixtures/domains.h"
#include "solve/basis.h"
#include "solve/basis_problems.h"

namespace pvg {
namespace {

struct Problem {
    explicit Problem(Domain domain_, double spacing = 0.05)
        : domain(std::move(domain_)),
          knots(place_knots(domain, {.spacing = spacing * domain.surface.diagonal()})),
          voronoi(geodesic_voronoi(domain, knots)),
          space(domain, knots, voronoi),
          system(domain, knots, voronoi),
          table(local_basis(space, {.threads = 2})) {}
    Problem(const Problem&) = delete;  // the space refers to its siblings

    Eigen::Index knot_count() const { return static_cast<Eigen::Index>(knots.vertex.size()); }
    Eigen::MatrixXd coefficients(const Eigen::MatrixXd& lambda) const {
        Eigen::MatrixXd all(table.coefficient_count, domain.channels);
        all.topRows(knot_count()) = lambda;
        for (std::size_t s = 0; s < domain.sources.size(); ++s)
            all.row(knot_count() + static_cast<Eigen::Index>(s)) = domain.sources[s].value;
        return all;
    }
    Eigen::VectorXd field(const Eigen::MatrixXd& lambda, int channel = 0) const {
        return fixtures::evaluate(table, coefficients(lambda).col(channel));
    }
    /// Dense Psi, from unit coefficients.
    Eigen::MatrixXd psi() const {
        Eigen::MatrixXd result(domain.surface.vertex_count(), knot_count());
        for (Eigen::Index j = 0; j < knot_count(); ++j)
            result.col(j) = fixtures::evaluate(table, Eigen::VectorXd::Unit(table.coefficient_count, j));
        return result;
    }
    Eigen::VectorXd load() const {
        Eigen::VectorXd result = Eigen::VectorXd::Zero(domain.surface.vertex_count());
        for (int v = 0; v < result.size(); ++v)
            for (int i = space.load_first[v]; i < space.load_first[v + 1]; ++i)
                result[v] += space.loads[i].second * domain.sources[space.loads[i].first].value[0];
        return result;
    }
    double energy_distance(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const {
        return std::sqrt((a - b).dot(space.S * (a - b)));
    }

    Domain domain;
    Knots knots;
    Voronoi voronoi;
    PatchSpace space;
    System system;
    Table table;
};

/// E of the free unknowns: two copies on a sharp Poisson curve are one.
Eigen::MatrixXd unknowns_to_knots(const Problem& p) {
    std::vector<int> follows(p.knot_count(), none);
    for (const Coupling& c : p.domain.couplings)
        if (c.left != c.right)
            follows[p.knots.knot_of_vertex[c.left]] = p.knots.knot_of_vertex[c.right];
    std::vector<int> column(p.knot_count(), none);
    int count = 0;
    for (Eigen::Index j = 0; j < p.knot_count(); ++j)
        if (follows[j] == none && !p.domain.dirichlet[p.knots.vertex[j]])
            column[j] = count++;
    Eigen::MatrixXd E = Eigen::MatrixXd::Zero(p.knot_count(), count);
    for (Eigen::Index j = 0; j < p.knot_count(); ++j) {
        int at = static_cast<int>(j);
        while (follows[at] != none) at = follows[at];
        if (column[at] != none)
            E(j, column[at]) = 1;
    }
    return E;
}

TEST(Galerkin, AgreesWithTheDenseCondition) {
    for (const bool jumps : {false, true}) {
        const Problem p(jumps ? fixtures::crossings_and_jump(40) : fixtures::three_curves(40), 0.08);
        Eigen::MatrixXd lambda = p.system.solve(p.domain);
        const Eigen::MatrixXd first = lambda;
        minimise_energy(p.space, p.table, p.system, {.max_steps = 400, .reduction = 1e-10, .settled = 0}, lambda);

        const Eigen::MatrixXd E = unknowns_to_knots(p), basis = p.psi() * E;
        ASSERT_EQ(E.cols(), p.system.unknowns());
        const Eigen::VectorXd forces = -(p.space.S * p.field(first)) - p.load();
        const Eigen::MatrixXd normal = basis.transpose() * (p.space.S * basis);
        const Eigen::VectorXd best = first.col(0) + E * normal.ldlt().solve(basis.transpose() * forces);
        // Float weights limit both; coefficients that the field hardly feels may differ, the field may not.
        const double range = p.field(best).maxCoeff() - p.field(best).minCoeff();
        EXPECT_LT((p.field(best) - p.field(lambda)).cwiseAbs().maxCoeff(), 1e-5 * range) << jumps;
        const Eigen::VectorXd left = basis.transpose() * (-(p.space.S * p.field(lambda)) - p.load());
        EXPECT_LT(left.norm(), 1e-5 * (basis.transpose() * forces).norm()) << jumps;
    }
}

TEST(Galerkin, EveryStepComesNearerInEnergy) {
    const Problem p(fixtures::three_curves(80), 0.03);
    const Eigen::VectorXd truth = fixtures::fem_solution(p.domain, fixtures::fem_stiffness(p.domain.surface));
    double last = p.energy_distance(p.field(p.system.solve(p.domain)), truth);
    const double first = last;
    for (int steps = 1; steps <= 12; ++steps) {
        Eigen::MatrixXd lambda = p.system.solve(p.domain);
        EXPECT_EQ(minimise_energy(p.space, p.table, p.system, {.max_steps = steps, .reduction = 1e-5, .settled = 0}, lambda),
                  steps);
        const double distance = p.energy_distance(p.field(lambda), truth);
        EXPECT_LT(distance, last) << steps;
        last = distance;
    }
    EXPECT_LT(last, 0.2 * first);
    // Better than what the basis makes of the truth at the knots: that is only one of the fields it can show.
    Eigen::MatrixXd exact(p.knot_count(), 1);
    for (Eigen::Index j = 0; j < p.knot_count(); ++j) exact(j, 0) = truth[p.knots.vertex[j]];
    Eigen::MatrixXd best = exact;
    minimise_energy(p.space, p.table, p.system, {.max_steps = 100, .settled = 0}, best);
    EXPECT_LT(p.energy_distance(p.field(best), truth), p.energy_distance(p.field(exact), truth));
}

TEST(Galerkin, TipsAndCrossings) {
    // Where values jump within an edge, two-point fluxes are 1.2 % off at the knots. The field that is evaluated is not.
    for (const bool crossing : {false, true}) {
        const Problem p(crossing ? fixtures::crossings_and_jump(120) : fixtures::slit_square(23600).domain, 0.03);
        const Eigen::VectorXd truth = fixtures::fem_solution(p.domain, p.space.S);
        Eigen::MatrixXd lambda = p.system.solve(p.domain);
        minimise_energy(p.space, p.table, p.system, {}, lambda);
        const double percent = 100 * (p.field(lambda) - truth).cwiseAbs().maxCoeff() / (truth.maxCoeff() - truth.minCoeff());
        std::printf("  %s: at most %.4f %%\n", crossing ? "crossing" : "tips", percent);
        EXPECT_LT(percent, 0.1);
    }
}

TEST(Galerkin, FixedKnotsAndJumpsStay) {
    const Problem p(fixtures::crossings_and_jump(60));
    const Eigen::MatrixXd before = p.system.solve(p.domain);
    Eigen::MatrixXd lambda = before;
    EXPECT_GT(minimise_energy(p.space, p.table, p.system, {}, lambda), 0);
    EXPECT_GT((lambda - before).cwiseAbs().maxCoeff(), 1e-6);
    int fixed = 0, jumps = 0;
    for (Eigen::Index j = 0; j < p.knot_count(); ++j)
        if (p.domain.dirichlet[p.knots.vertex[j]]) {
            EXPECT_EQ(lambda(j, 0), before(j, 0));
            ++fixed;
        }
    for (const Coupling& c : p.domain.couplings) {
        if (p.domain.dirichlet[c.left] || p.domain.dirichlet[c.right])
            continue;
        EXPECT_NEAR(lambda(p.knots.knot_of_vertex[c.left], 0) - lambda(p.knots.knot_of_vertex[c.right], 0), c.jump[0], 1e-12);
        ++jumps;
    }
    EXPECT_GT(fixed, 20);
    EXPECT_GT(jumps, 10);
}

TEST(Galerkin, WhatIsExactStaysSo) {
    // Linear in the plane, all values on the border given: the cell system has it, and nothing pulls it away.
    Domain domain = fixtures::plain_domain(fixtures::irregular_plane(40, 40));
    for (int v = 0; v < domain.surface.vertex_count(); ++v)
        if (domain.surface.is_border_vertex(v))
            fixtures::fix(domain, v, domain.surface.point(v).x() - 2 * domain.surface.point(v).y());
    const Problem p(std::move(domain), 0.1);
    Eigen::MatrixXd lambda = p.system.solve(p.domain);
    minimise_energy(p.space, p.table, p.system, {}, lambda);
    for (Eigen::Index j = 0; j < p.knot_count(); ++j) {
        const Point at = p.domain.surface.point(p.knots.vertex[j]);
        EXPECT_NEAR(lambda(j, 0), at.x() - 2 * at.y(), 1e-6);
    }
}

TEST(Galerkin, ChannelsDoNotTouchEachOther) {
    Domain three = fixtures::three_curves(60), one = three;
    three.channels = 3;
    const Eigen::VectorXd values = one.dirichlet_value.col(0);
    three.dirichlet_value.resize(values.size(), 3);
    three.dirichlet_value << 5 * values, Eigen::VectorXd::Zero(values.size()), values;
    for (std::size_t s = 0; s < three.sources.size(); ++s) {
        const double value = one.sources[s].value[0];
        three.sources[s].value.resize(3);
        three.sources[s].value << 0, 0, value;
    }
    const Problem single(std::move(one)), triple(std::move(three));
    Eigen::MatrixXd a = single.system.solve(single.domain), b = triple.system.solve(triple.domain);
    minimise_energy(single.space, single.table, single.system, {}, a);
    minimise_energy(triple.space, triple.table, triple.system, {}, b);
    EXPECT_LT((a.col(0) - b.col(2)).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_TRUE(b.col(1).isZero(0));
    EXPECT_TRUE(b.allFinite());
}

}  // namespace
}  // namespace pvg
