// Laws of the paper's basis (solve/green_basis.h), and its errors against finite elements (cpu_reference/ACCURACY.md).
#include <cmath>
#include <cstring>
#include <thread>
#include <tuple>

#include <gtest/gtest.h>

#include "fixtures/domains.h"
#include "solve/basis.h"
#include "solve/basis_problems.h"
#include "solve/field.h"
#include "solve/green_basis.h"
#include "solve/system.h"

namespace pvg {
namespace {

/// A problem up to the paper's basis. Spacing in units of the diagonal.
/// Spacing and grading alone decide where knots are: the paper's basis is studied by their distance.
struct Built {
    explicit Built(Domain domain_, double spacing = 0.05, double grading = 0.25)
        : domain(std::move(domain_)),
          knots(place_knots(
              domain, {.spacing = spacing * domain.surface.diagonal(), .grading = grading, .curvature = 1e9, .most_edges = 1e9})),
          voronoi(geodesic_voronoi(domain, knots)),
          space(domain, knots, voronoi),
          green(space, voronoi) {}
    Built(const Built&) = delete;  // the space refers to its siblings

    int knot_count() const { return static_cast<int>(knots.vertex.size()); }
    int vertex_count() const { return domain.surface.vertex_count(); }
    Eigen::MatrixXd cell_lambda() const { return System(domain, knots, voronoi).solve(domain); }
    Eigen::MatrixXd random_lambda() const {
        fixtures::Random random(3);
        return Eigen::MatrixXd::NullaryExpr(knot_count(), 2, [&](auto, auto) { return random.real(-1, 1); });
    }
    Eigen::VectorXd truth() const { return fixtures::fem_solution(domain, space.S); }
    /// Rows of a table against lambda; source columns, where they are listed at all, count as 0.
    Eigen::VectorXd rows(const Table& table, const Eigen::VectorXd& lambda) const {
        Eigen::VectorXd all = Eigen::VectorXd::Zero(table.coefficient_count);
        all.head(knot_count()) = lambda;
        return fixtures::evaluate(table, all);
    }
    fixtures::TableError error(const Eigen::VectorXd& u) const { return fixtures::compare(domain, space.S, truth(), u); }
    /// As a user gets it.
    Eigen::VectorXd field(const BasisChoice& choice) const {
        const System system(domain, knots, voronoi);
        const Table table = basis_table(space, voronoi, choice, {.threads = 2});
        const Result<bool> valid = validate(table);
        EXPECT_TRUE(valid.ok()) << valid.error().what();
        const Coefficients solved = solve_coefficients(space, voronoi, system, table, choice, system.solve(domain));
        Eigen::VectorXd all(table.coefficient_count);
        EXPECT_EQ(solved.values.size(), table.coefficient_count * table.channels);
        for (Eigen::Index i = 0; i < all.size(); ++i) all[i] = solved.values[i];
        return fixtures::evaluate(table, all);
    }

    Domain domain;
    Knots knots;
    Voronoi voronoi;
    PatchSpace space;
    GreenBasis green;
};

Domain closed_sphere() {
    Domain domain = fixtures::plain_domain(fixtures::icosphere(12));
    fixtures::fix(domain, 5, 1);
    fixtures::fix(domain, 900, 0);
    return domain;
}

Domain open_plane() {
    Domain domain = fixtures::plain_domain(fixtures::irregular_plane(25, 25));
    fixtures::fix(domain, 300, 1);
    return domain;
}

struct Case {
    const char* name;
    Domain (*domain)();
    int components;
};

/// Closed, open, slit, several components (joined by a sharp Poisson curve, or by nothing).
const Case cases[] = {
    {"closed", [] { return closed_sphere(); }, 1},
    {"open", [] { return open_plane(); }, 1},
    {"slit", [] { return fixtures::three_curves(30); }, 1},
    {"slit sphere", [] { return fixtures::sphere_curves(12); }, 1},
    {"crossings, a closed curve, a jump", [] { return fixtures::crossings_and_jump(40); }, 2},
    {"island", [] { return fixtures::island(30); }, 2},
};

class GreenLaws : public testing::TestWithParam<Case> {};

TEST_P(GreenLaws, UntruncatedColumnsSumToOne) {
    const Built built(GetParam().domain(), 0.08);
    int components = 0;
    face_components(built.domain.surface, &components);
    EXPECT_EQ(components, GetParam().components);
    const Eigen::MatrixXd psi = built.green.columns(0, built.knot_count());
    EXPECT_LT((psi.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-9);
    // Not by being trivial: no column is a constant.
    EXPECT_GT((psi.colwise().maxCoeff() - psi.colwise().minCoeff()).minCoeff(), 0.1);
}

TEST_P(GreenLaws, ColumnsTimesLambdaAreTheExactSum) {
    const Built built(GetParam().domain(), 0.08);
    const Eigen::MatrixXd lambda = built.random_lambda();
    const Eigen::MatrixXd psi = built.green.columns(0, built.knot_count());
    EXPECT_LT((psi * lambda - built.green.sum(lambda)).cwiseAbs().maxCoeff(), 1e-9);
    // Constants, one a component, come out as they are.
    EXPECT_LT((built.green.sum(Eigen::MatrixXd::Constant(built.knot_count(), 1, 3)).array() - 3).abs().maxCoeff(), 1e-9);
}

TEST_P(GreenLaws, ColumnsAreThePapersSumOfGreensFunctions) {
    const Built built(GetParam().domain(), 0.1);
    const GreenOperator inverse(built.domain.surface);
    const int n = built.knot_count();
    Eigen::MatrixXd phibar(built.vertex_count(), n);
    for (int j = 0; j < n; ++j) {
        const int component = inverse.component(built.knots.vertex[j]);
        const Eigen::VectorXd d = built.green.charge(j);
        EXPECT_NEAR(d.sum(), 1, 1e-12);
        RowMatrix charges = RowMatrix::Zero(built.vertex_count(), 4), work;
        for (int v = 0; v < built.vertex_count(); ++v)
            if (inverse.component(v) == component)
                charges(v, 0) = inverse.lumped_area()[v] / inverse.component_area(component) - d[v];
            else
                ASSERT_EQ(d[v], 0);
        const Eigen::VectorXd right = charges.col(0);
        inverse.apply(charges, work);
        phibar.col(j) = charges.col(0);
        EXPECT_LT((inverse.stiffness() * phibar.col(j) - right).cwiseAbs().maxCoeff(), 1e-10);
        EXPECT_NEAR(phibar.col(j).dot(inverse.lumped_area()), 0, 1e-12);
    }
    Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(built.vertex_count(), n);
    for (const CellEdge& edge : built.voronoi.edges) {
        expected.col(edge.a) += edge.weight * (phibar.col(edge.b) - phibar.col(edge.a));
        expected.col(edge.b) += edge.weight * (phibar.col(edge.a) - phibar.col(edge.b));
    }
    // Up to the constant that a Green's function leaves open: psi's mean over the knots is A_j / A_M.
    const Eigen::MatrixXd difference = built.green.columns(0, n) - expected;
    for (int j = 0; j < n; ++j) {
        const int component = inverse.component(built.knots.vertex[j]);
        double low = 1e300, high = -1e300, area = 0, mean = 0;
        for (int v = 0; v < built.vertex_count(); ++v) {
            const double value = difference(v, j);
            if (inverse.component(v) == component) {
                low = std::min(low, value);
                high = std::max(high, value);
            } else {
                EXPECT_EQ(value, 0);
            }
        }
        EXPECT_LT(high - low, 1e-9);
        for (int i = 0; i < n; ++i)
            if (inverse.component(built.knots.vertex[i]) == component) {
                area += built.voronoi.area[i];
                mean += built.voronoi.area[i] * (expected(built.knots.vertex[i], j) + high);
            }
        EXPECT_NEAR(mean / area, built.voronoi.area[j] / area, 1e-9);
    }
}

TEST_P(GreenLaws, TablesAreValidAndDirichletRowsTheirOwnKnot) {
    const Built built(GetParam().domain(), 0.08);
    const Eigen::VectorXd lambda = built.random_lambda().col(0);
    for (const bool normalize : {true, false}) {
        const Table table = built.green.table({.normalize = normalize, .threads = 2});
        const Result<bool> valid = validate(table);
        ASSERT_TRUE(valid.ok()) << valid.error().what();
        EXPECT_EQ(table.coefficient_count, built.knots.vertex.size() + built.domain.sources.size());
        const Eigen::VectorXd u = built.rows(table, lambda), sums = built.rows(table, Eigen::VectorXd::Ones(lambda.size()));
        for (int v = 0; v < u.size(); ++v)
            if (built.domain.dirichlet[v]) {
                EXPECT_EQ(u[v], lambda[built.knots.knot_of_vertex[v]]);
            }
        const double off = (sums.array() - 1).abs().maxCoeff();
        EXPECT_TRUE(normalize ? off < 2e-6 : off > 1e-3) << off;  // lists of 20 to 30 weights, each rounded to float
    }
}

INSTANTIATE_TEST_SUITE_P(All, GreenLaws, testing::ValuesIn(cases), [](const auto& test) {
    std::string name = test.param.name;
    std::erase_if(name, [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); });
    return name;
});

TEST(Green, TablesThatReachEverythingAreTheExactSum) {
    // 16 rings span the whole domain: what the table stores is then all of psi.
    const Built built(closed_sphere(), 0.1);
    const Eigen::VectorXd lambda = built.random_lambda().col(0);
    const Table table = built.green.table({.rings = 16, .normalize = false, .threads = 2});
    ASSERT_EQ(table.indices.size(), static_cast<std::size_t>(built.knot_count()) * ((built.knot_count() + 3) / 4 * 4));
    Eigen::VectorXd exact = built.green.sum(lambda).col(0);
    for (int v = 0; v < exact.size(); ++v)
        if (built.domain.dirichlet[v])
            exact[v] = lambda[built.knots.knot_of_vertex[v]];
    EXPECT_LT((built.rows(table, lambda) - exact).cwiseAbs().maxCoeff(), 1e-6) << "float weights";
}

TEST(Green, SpheresGreensFunctionHasTheAnalyticSignAndValue) {
    // Delta phi = delta - 1 / area: phi = (log(1 - cos theta) - log 2 + 1) / (4 pi), of mean zero.
    double last = 0;
    for (const int frequency : {10, 20, 40}) {
        const Domain domain = fixtures::plain_domain(fixtures::icosphere(frequency));
        const Knots knots = place_knots(domain, {.spacing = 1});
        const Voronoi voronoi = geodesic_voronoi(domain, knots);
        const PatchSpace space(domain, knots, voronoi);
        const GreenOperator inverse(space.domain.surface);
        ASSERT_EQ(inverse.component_count(), 1);
        const int pole = fixtures::nearest_vertex(domain.surface, {0.3, 0.5, 0.81});
        RowMatrix phi = RowMatrix::Zero(domain.surface.vertex_count(), 4), work;
        phi.col(0) = inverse.lumped_area() / inverse.component_area(0);
        phi(pole, 0) -= 1;
        inverse.apply(phi, work);
        double worst = 0;
        for (int v = 0; v < domain.surface.vertex_count(); ++v) {
            const double cosine = domain.surface.point(v).dot(domain.surface.point(pole));
            if (std::acos(std::min(1.0, cosine)) < 0.3)
                continue;
            const double truth = (std::log(1 - cosine) - std::log(2.0) + 1) / (4 * std::numbers::pi);
            worst = std::max(worst, std::abs(phi(v, 0) - truth));
        }
        const double order = last > 0 ? std::log2(last / worst) : 2;
        std::printf("  %5d vertices: largest error %.2e, order %.2f\n", domain.surface.vertex_count(), worst, order);
        EXPECT_GE(order, 1.5);
        last = worst;
    }
    EXPECT_LT(last, 1e-3);  // phi ranges over 0.3
}

TEST(Green, TruncationCostsOnASphereAndRenormalisingHelps) {
    const Built built(fixtures::sphere_curves(30), 0.03);
    const BasisChoice green{BasisKind::green, 2, true}, raw{BasisKind::green, 2, false}, exact{BasisKind::exact}, local{};
    fixtures::TableError errors[4];
    const std::pair<const char*, BasisChoice> rows[] = {
        {"raw", raw}, {"renormalised", green}, {"exact", exact}, {"local", local}};
    std::printf("  sphere, %d vertices, %d knots\n", built.vertex_count(), built.knot_count());
    for (int i = 0; i < 4; ++i) {
        errors[i] = built.error(built.field(rows[i].second));
        std::printf("  %-12s mean %.4f  max %.3f  H1 %.2f\n", rows[i].first, errors[i].mean, errors[i].max, errors[i].h1);
    }
    for (int i = 0; i < 3; ++i) {
        EXPECT_GT(errors[i].mean, 1.5 * errors[i + 1].mean);
        EXPECT_GT(errors[i].max, 1.5 * errors[i + 1].max);
        EXPECT_GT(errors[i].h1, 1.5 * errors[i + 1].h1);
    }
    // The method page: 1.55 / 25 raw, 0.20 / 4.5 renormalised, 0.12 / 2.9 exact, at 3,664 knots.
    EXPECT_LT(errors[1].mean, 0.25);
    EXPECT_LT(errors[2].mean, 0.12);
}

TEST(Green, ExactSumConvergesToFiniteElementsWithTheKnots) {
    // Between smooth curves of second order. Slit, with tips, an open border and a source: slower, knots at tips stay as they
    // are.
    const std::tuple<const char*, Domain, double, double> problems[] = {{"band", fixtures::sphere_band(10000).domain, 0.4, 0.05},
                                                                        {"slit", fixtures::three_curves(100), 0.95, 0.05}};
    for (const auto& [name, domain, factor, bar] : problems) {
        double last = 1e9;
        for (const double fine : {1.0, 0.5, 0.25}) {
            const Built built(domain, 0.12 * fine, 0.6 * fine);
            const fixtures::TableError error = built.error(built.field({BasisKind::exact}));
            std::printf("  %s, %5d knots: mean %.4f  max %.3f  H1 %.2f\n", name, built.knot_count(), error.mean, error.max,
                        error.h1);
            EXPECT_LT(error.mean, factor * last);
            last = error.mean;
        }
        EXPECT_LT(last, bar);
    }
}

TEST(Green, ASourceEverywhereIsExact) {
    // Charges over the pieces of cells give back the hat functions' integrals: 0.5 % with whole vertices instead.
    const Built built(fixtures::disk_domain(50), 0.03);
    const fixtures::TableError error = built.error(built.field({BasisKind::exact}));
    EXPECT_LT(error.mean, 0.02);
    EXPECT_LT(error.max, 0.3);
}

TEST(Green, SharpPoissonCurvesAreRightOnBothSides) {
    for (const bool closed : {true, false}) {
        const Built built(closed ? fixtures::island(60) : fixtures::crossings_and_jump(80), 0.03);
        ASSERT_GT(built.domain.couplings.size(), 20u);
        const Eigen::VectorXd u = built.field({BasisKind::exact});
        const fixtures::TableError error = built.error(u);
        std::printf("  %s: mean %.4f  max %.3f  H1 %.2f\n", closed ? "closed" : "open", error.mean, error.max, error.h1);
        EXPECT_LT(error.mean, 0.15);
        EXPECT_LT(error.max, 0.6);
        const Eigen::VectorXd truncated = built.field({BasisKind::green, 2, true});
        for (const Coupling& c : built.domain.couplings) {
            EXPECT_NEAR(u[c.left] - u[c.right], c.jump[0], 1e-6);  // floats of size up to 2
            EXPECT_NEAR(truncated[c.left] - truncated[c.right], c.jump[0], 1e-6);
        }
        const fixtures::TableError green = built.error(truncated);
        EXPECT_LT(green.mean, 0.3);
    }
}

TEST(Green, AgreesWithTheLocalBasis) {
    for (const auto& domain : {fixtures::three_curves(80), fixtures::crossings_and_jump(80)}) {
        const Built built(domain, 0.03);
        const Eigen::VectorXd local = built.field({}), exact = built.field({BasisKind::exact});
        const fixtures::TableError apart = fixtures::compare(built.domain, built.space.S, local, exact);
        EXPECT_LT(apart.mean, 0.15);
        EXPECT_LT(apart.max, 0.6);
    }
}

TEST(Green, ThreadsAndBatchesChangeNoByte) {
    const Built built(fixtures::three_curves(40), 0.05);
    const Table table = built.green.table({.threads = 1});
    const std::pair<int, int> others[] = {{3, 16}, {2, 1}, {1, 5}, {2, 64}, {1, 100000}};
    for (const auto& [threads, batch] : others) {
        const Table other = built.green.table({.threads = threads, .batch = batch});
        ASSERT_EQ(table.weights.size(), other.weights.size());
        EXPECT_EQ(std::memcmp(table.weights.data(), other.weights.data(), table.weights.size() * sizeof(float)), 0)
            << threads << " threads, batches of " << batch;
        EXPECT_EQ(table.indices, other.indices);
        EXPECT_EQ(table.row_vertex, other.row_vertex);
    }
}

TEST(Green, ProgressRisesToOneOnTheCallingThread) {
    const Built built(open_plane(), 0.1);
    std::vector<double> seen;
    const auto caller = std::this_thread::get_id();
    built.green.table({.threads = 1, .batch = 4, .on_progress = [&](double part) {
                           EXPECT_EQ(std::this_thread::get_id(), caller);
                           seen.push_back(part);
                       }});
    ASSERT_EQ(seen.size(), static_cast<std::size_t>((built.knot_count() + 3) / 4));
    EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
    EXPECT_EQ(seen.back(), 1);
}

TEST(Green, RotationAndScaleChangeNothing) {
    const Built built(fixtures::three_curves(40), 0.05);
    Domain moved = built.domain;
    moved.surface = fixtures::scaled(fixtures::rotated(built.domain.surface, 1.1), 37);
    const Knots knots = built.knots;
    const Voronoi voronoi = geodesic_voronoi(moved, knots);
    const PatchSpace space(moved, knots, voronoi);
    const Eigen::MatrixXd lambda = built.random_lambda();
    EXPECT_LT((GreenBasis(space, voronoi).sum(lambda) - built.green.sum(lambda)).cwiseAbs().maxCoeff(), 1e-7);
}

TEST(Green, NumberingChangesNothing) {
    const Domain domain = open_plane();
    const Built built(domain, 0.1);
    const fixtures::Permuted permuted = fixtures::permuted(domain.surface, 8);
    Domain other = fixtures::plain_domain(permuted.surface);
    for (int v = 0; v < domain.surface.vertex_count(); ++v)
        if (domain.dirichlet[v])
            fixtures::fix(other, permuted.vertex[v], 1);
    Knots knots;
    knots.knot_of_vertex.assign(domain.surface.vertex_count(), none);
    for (int v : built.knots.vertex) knots.vertex.push_back(permuted.vertex[v]);
    std::sort(knots.vertex.begin(), knots.vertex.end());
    for (int j = 0; j < built.knot_count(); ++j) knots.knot_of_vertex[knots.vertex[j]] = j;
    const Eigen::MatrixXd lambda = built.random_lambda();
    Eigen::MatrixXd reordered(lambda.rows(), lambda.cols());
    for (int j = 0; j < built.knot_count(); ++j)
        reordered.row(knots.knot_of_vertex[permuted.vertex[built.knots.vertex[j]]]) = lambda.row(j);
    const Voronoi voronoi = geodesic_voronoi(other, knots);
    const PatchSpace space(other, knots, voronoi);
    const Eigen::MatrixXd u = built.green.sum(lambda), w = GreenBasis(space, voronoi).sum(reordered);
    double worst = 0;
    for (int v = 0; v < built.vertex_count(); ++v)
        worst = std::max(worst, (u.row(v) - w.row(permuted.vertex[v])).cwiseAbs().maxCoeff());
    EXPECT_LT(worst, 1e-9);
}

TEST(Green, TinyMeshes) {
    for (const Surface& surface : {fixtures::cuboid(), fixtures::icosphere(1), fixtures::plane(1, 1)}) {
        Domain domain = fixtures::plain_domain(surface);
        fixtures::fix(domain, 0, 1);
        const Built built(std::move(domain), 1);
        for (const BasisKind kind : {BasisKind::green, BasisKind::exact})
            EXPECT_LT((built.field({kind}).array() - 1).abs().maxCoeff(), 1e-6);
    }
}

}  // namespace
}  // namespace pvg
