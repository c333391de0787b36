// The maximum principle as a user gets it: lambda, and the field that the table makes of it.
#include <algorithm>
#include <cstdio>
#include <limits>

#include <gtest/gtest.h>

#include "solve/bad_domains.h"
#include "solve/basis.h"
#include "solve/bounds.h"
#include "solve/galerkin.h"
#include "solve/system.h"

namespace pvg {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Two copies of a domain side by side: parts 0 and 1. Channel 1 is 3 - channel 0 in part 0 and as rough as can be in part 1,
/// channel 2 is constant in each.
Domain two_parts(const Domain& one) {
    Domain both = one;
    const int vertices = one.surface.vertex_count();
    std::vector<Point> points = one.surface.points();
    std::vector<Face> faces = one.surface.faces();
    for (int v = 0; v < vertices; ++v) points.push_back(one.surface.point(v) + Point(10, 0, 0));
    for (const Face& f : one.surface.faces()) faces.push_back({f[0] + vertices, f[1] + vertices, f[2] + vertices});
    both.surface = Surface(points, faces);
    for (int v = 0; v < vertices; ++v) both.vertex_parent.push_back(one.vertex_parent[v] + vertices);
    for (int f = 0; f < one.surface.face_count(); ++f) both.face_parent.push_back(one.surface.face_count() + f);
    both.dirichlet.insert(both.dirichlet.end(), one.dirichlet.begin(), one.dirichlet.end());
    both.on_curve.insert(both.on_curve.end(), one.on_curve.begin(), one.on_curve.end());
    both.feature.insert(both.feature.end(), one.feature.begin(), one.feature.end());
    both.edge_length.insert(both.edge_length.end(), one.edge_length.begin(), one.edge_length.end());
    both.channels = 3;
    both.dirichlet_value = Eigen::MatrixXd::Zero(2 * vertices, 3);
    for (int v = 0; v < 2 * vertices; ++v)
        if (both.dirichlet[v]) {
            const double value = one.dirichlet_value(v % vertices, 0);
            if (v < vertices)
                both.dirichlet_value.row(v) << value, 3 - value, 7;
            else
                both.dirichlet_value.row(v) << 100 + 5 * value, (v * 37 / 5) % 2, -7;
        }
    both.sources.clear();
    both.couplings.clear();
    for (const Coupling& c : one.couplings)
        for (int shift : {0, vertices}) both.couplings.push_back({c.left + shift, c.right + shift, Eigen::RowVectorXd::Zero(3)});
    return both;
}

TEST(Bounds, OfPartsAndChannels) {
    Domain domain = two_parts(fixtures::three_curves(20, false));
    const int vertices = domain.surface.vertex_count() / 2;
    PartBounds bounds = part_bounds(domain);
    ASSERT_EQ(bounds.low.rows(), 2);
    EXPECT_EQ(bounds.part[0], 0);
    EXPECT_EQ(bounds.part[vertices], 1);
    for (int c = 0; c < 3; ++c) {
        double low = infinity, high = -infinity;
        for (int v = 0; v < vertices; ++v)
            if (domain.dirichlet[v]) {
                low = std::min(low, domain.dirichlet_value(v, c));
                high = std::max(high, domain.dirichlet_value(v, c));
            }
        EXPECT_EQ(bounds.low(0, c), low);
        EXPECT_EQ(bounds.high(0, c), high);
    }
    EXPECT_EQ(bounds.low(1, 2), -7);
    // A source opens its own part in its own channels only, one that is 0 none.
    SourceColumn source{"bump", {{0, 1.0}}, Eigen::RowVectorXd::Zero(3)};
    domain.sources.push_back(source);
    EXPECT_EQ(part_bounds(domain).low, bounds.low);
    domain.sources[0].value[1] = -2;
    bounds.low(0, 1) = -infinity;
    bounds.high(0, 1) = infinity;
    EXPECT_EQ(part_bounds(domain).low, bounds.low);
    EXPECT_EQ(part_bounds(domain).high, bounds.high);
    // A part without a given value has no bounds.
    for (int v = vertices; v < 2 * vertices; ++v) domain.dirichlet[v] = 0;
    EXPECT_TRUE((part_bounds(domain).low.row(1).array() == -infinity).all());
}

TEST(Bounds, JumpsOpenTheirPart) {
    Domain domain = fixtures::crossings_and_jump(40);
    EXPECT_EQ(part_bounds(domain).low(0, 0), -infinity);
    for (Coupling& c : domain.couplings) c.jump.setZero();
    EXPECT_GT(part_bounds(domain).low(0, 0), -infinity);
}

TEST(Bounds, LambdaAndFieldStayBetweenTheCurvesValues) {
    double left = 0;
    for (const auto& [name, one] : fixtures::bad_domains()) {
        const Domain domain = two_parts(one);
        const Knots knots = place_knots(domain, {.spacing = 0.08 * one.surface.diagonal()});
        const Voronoi voronoi = geodesic_voronoi(domain, knots);
        const System system(domain, knots, voronoi);
        const PatchSpace space(domain, knots, voronoi);
        const Table table = local_basis(space, {.threads = 2});
        Eigen::MatrixXd free = system.solve(domain), lambda = free;
        minimise_energy(space, table, system, {.bounded = false}, free);
        minimise_energy(space, table, system, {}, lambda);
        const PartBounds bounds = part_bounds(domain);
        double lambda_out = 0, free_out = 0, field_out = 0;
        for (int c = 0; c < 3; ++c) {
            const Eigen::VectorXd u = fixtures::evaluate(table, lambda.col(c));
            const auto out = [&](int v, double value) {
                const int p = bounds.part[v];
                const double low = bounds.low(p, c), high = bounds.high(p, c);
                const double range = high > low ? high - low : std::abs(high);
                return std::max({low - value, value - high, 0.0}) / range;
            };
            for (Eigen::Index j = 0; j < lambda.rows(); ++j) {
                lambda_out = std::max(lambda_out, out(knots.vertex[j], lambda(j, c)));
                free_out = std::max(free_out, out(knots.vertex[j], free(j, c)));
            }
            for (int v = 0; v < u.size(); ++v) field_out = std::max(field_out, out(v, u[v]));
        }
        std::printf("%-36s outside by %.1e of the range before, lambda %.1e, field %.1e\n", name, free_out, lambda_out,
                    field_out);
        EXPECT_LE(lambda_out, 1e-6) << name;
        EXPECT_LE(field_out, 0.0039) << name;
        left = std::max(left, free_out);
    }
    EXPECT_GT(left, 0) << "energy-optimal coefficients never left their bounds";
}

TEST(Bounds, WhatLeavesThemIsPutBackAndNothingElseMoves) {
    Domain domain = two_parts(fixtures::three_curves(20, false));
    SourceColumn source{"bump", {{0, 1.0}}, Eigen::RowVectorXd::Zero(3)};
    source.value[1] = -2;
    domain.sources.push_back(source);
    const Knots knots = place_knots(domain, {.spacing = 0.1});
    const PartBounds bounds = part_bounds(domain);
    Eigen::MatrixXd lambda(static_cast<Eigen::Index>(knots.vertex.size()), 3);
    for (Eigen::Index j = 0; j < lambda.rows(); ++j)
        for (int c = 0; c < 3; ++c) lambda(j, c) = 0.4 + 3.0 * std::sin(1.7 * static_cast<double>(3 * j + c));
    const Eigen::MatrixXd before = lambda;
    EXPECT_GT(keep_between_bounds(domain, knots, lambda), 1);
    int moved = 0;
    for (Eigen::Index j = 0; j < lambda.rows(); ++j)
        for (int c = 0; c < 3; ++c) {
            const int p = bounds.part[knots.vertex[j]];
            EXPECT_GE(lambda(j, c), bounds.low(p, c));
            EXPECT_LE(lambda(j, c), bounds.high(p, c));
            if (before(j, c) >= bounds.low(p, c) && before(j, c) <= bounds.high(p, c)) {
                EXPECT_EQ(lambda(j, c), before(j, c));
            } else {
                ++moved;
            }
        }
    EXPECT_GT(moved, 50);
    EXPECT_EQ(lambda.col(1).head(5), before.col(1).head(5)) << "the part with the source is not bounded";
}

TEST(Bounds, KeepingThemIsNoStepAwayFromTheTruth) {
    for (const auto& [name, one] : fixtures::bad_domains()) {
        Domain domain = one;
        domain.sources.clear();
        for (Coupling& c : domain.couplings) c.jump.setZero();
        const Knots knots = place_knots(domain, {.spacing = 0.04 * one.surface.diagonal()});
        const Voronoi voronoi = geodesic_voronoi(domain, knots);
        const System system(domain, knots, voronoi);
        const PatchSpace space(domain, knots, voronoi);
        const Table table = local_basis(space, {.threads = 2});
        const Eigen::VectorXd truth = fixtures::fem_solution(domain, space.S);
        Eigen::MatrixXd free = system.solve(domain), kept;
        minimise_energy(space, table, system, {.bounded = false}, free);
        kept = free;
        keep_between_bounds(domain, knots, kept);
        for (Eigen::Index j = 0; j < kept.rows(); ++j) {
            const double at = truth[knots.vertex[j]];
            EXPECT_LE(std::abs(kept(j, 0) - at), std::abs(free(j, 0) - at) + 1e-12) << name;
        }
    }
}

}  // namespace
}  // namespace pvg
