// Laws of the local basis, and its errors against finite elements on the same vertices (cpu_reference/ACCURACY.md).
#include <cmath>
#include <cstring>
#include <set>

#include <gtest/gtest.h>

#include "fixtures/domains.h"
#include "solve/basis.h"
#include "solve/basis_problems.h"
#include "solve/galerkin.h"
#include "solve/system.h"

namespace pvg {
namespace {

/// A problem with everything the table is made of. At default density: spacing 0.03 of the diagonal.
struct Built {
    explicit Built(Domain domain_, double spacing = 0.03)
        : domain(std::move(domain_)),
          knots(place_knots(domain, {.spacing = spacing * domain.surface.diagonal()})),
          voronoi(geodesic_voronoi(domain, knots)),
          space(domain, knots, voronoi),
          table(local_basis(space, {.threads = 2})) {}
    Built(const Built&) = delete;  // the space refers to its siblings

    int knot_count() const { return static_cast<int>(knots.vertex.size()); }
    /// As a user gets it.
    Eigen::MatrixXd lambda() const {
        const System system(domain, knots, voronoi);
        Eigen::MatrixXd result = system.solve(domain);
        minimise_energy(space, table, system, {}, result);
        return result;
    }
    /// Knots' values of a function of the vertex, sources at their own.
    Eigen::VectorXd coefficients(const std::function<double(int)>& value) const {
        Eigen::VectorXd result(knot_count() + domain.sources.size());
        for (int j = 0; j < knot_count(); ++j) result[j] = value(knots.vertex[j]);
        for (std::size_t s = 0; s < domain.sources.size(); ++s) result[knot_count() + s] = domain.sources[s].value[0];
        return result;
    }

    Domain domain;
    Knots knots;
    Voronoi voronoi;
    PatchSpace space;
    Table table;
};

const Built& three_curves() {
    static const Built built(fixtures::three_curves(80));
    return built;
}

const Built& crossings_and_jump() {
    static const Built built(fixtures::crossings_and_jump(80));
    return built;
}

/// The bent square, its border and two curves Dirichlet: every linear function has its own values everywhere.
Domain closed_square() {
    const fixtures::BentSquare square(60);
    std::vector<fixtures::Chain> chains(2);
    chains[0].vertices = square.line({{0.2, 0.3}, {0.6, 0.3}, {0.6, 0.5}});
    chains[1].vertices = square.line({{0.3, 0.7}, {0.8, 0.7}});
    for (auto& chain : chains) chain.left = chain.right = [](const Point&) { return 0.0; };
    Domain domain = square.domain(chains);
    for (int v = 0; v < domain.surface.vertex_count(); ++v)
        if (domain.surface.is_border_vertex(v))
            fixtures::fix(domain, v, 0);
    return domain;
}

TEST(BasisLaws, TablesAreValid) {
    for (const Built* built : {&three_curves(), &crossings_and_jump()}) {
        const Result<bool> valid = validate(built->table);
        EXPECT_TRUE(valid.ok()) << valid.error().what();
        EXPECT_EQ(built->table.row_count, static_cast<std::uint32_t>(built->domain.surface.vertex_count()));
        EXPECT_EQ(built->table.coefficient_count, built->knots.vertex.size() + built->domain.sources.size());
    }
}

TEST(BasisLaws, RowsSumToOneOverTheKnots) {
    for (const Built* built : {&three_curves(), &crossings_and_jump()}) {
        Eigen::VectorXd ones = Eigen::VectorXd::Zero(built->table.coefficient_count);
        ones.head(built->knot_count()).setOnes();
        // 24 weights of size up to 3, each rounded to float.
        EXPECT_LT((fixtures::evaluate(built->table, ones).array() - 1).abs().maxCoeff(), 1e-6);
    }
}

TEST(BasisLaws, LinearFunctionsInThePlaneAreExact) {
    const Built built(closed_square());
    for (const Point& direction : {Point(1, 0, 0), Point(0, 1, 0), Point(0.6, -0.8, 0)}) {
        const auto value = [&](int v) { return built.domain.surface.point(v).dot(direction); };
        const Eigen::VectorXd u = fixtures::evaluate(built.table, built.coefficients(value));
        double worst = 0;
        for (int v = 0; v < u.size(); ++v) worst = std::max(worst, std::abs(u[v] - value(v)));
        EXPECT_LT(worst, 1e-5) << "float weights on values up to 1";
    }
}

TEST(BasisLaws, JumpsAreExact) {
    // 1 inside a closed sharp Poisson curve with jump 1, 0 outside, where a diffusion curve fixes 0.
    const fixtures::BentSquare square(60);
    std::vector<fixtures::Chain> chains(2);
    chains[0].vertices = square.line({{0.3, 0.3}, {0.7, 0.3}, {0.7, 0.7}, {0.3, 0.7}, {0.3, 0.3}});
    chains[0].jump = [](const Point&) { return 1.0; };
    chains[1].vertices = square.line({{0.1, 0.1}, {0.9, 0.1}});
    chains[1].left = chains[1].right = [](const Point&) { return 0.0; };
    const Built built(square.domain(chains), 0.05);
    ASSERT_EQ(built.domain.couplings.size(), 4u * 24);
    const Eigen::VectorXd truth = fixtures::fem_solution(built.domain, fixtures::fem_stiffness(built.domain.surface));
    const Eigen::VectorXd u =
        fixtures::evaluate(built.table, built.coefficients([&](int v) { return truth[v] > 0.5 ? 1.0 : 0.0; }));
    EXPECT_GT(truth.maxCoeff(), 0.999);
    for (int v = 0; v < u.size(); ++v) EXPECT_NEAR(u[v], truth[v] > 0.5 ? 1.0 : 0.0, 2e-6);
}

TEST(BasisLaws, EitherCopyMayBeCalledLeft) {
    // Imprinted curves do not keep to one side. Here every third coupling is turned around; the field is the same.
    const fixtures::BentSquare square(60);
    std::vector<fixtures::Chain> chains(2);
    chains[0].vertices = square.line({{0.3, 0.3}, {0.7, 0.3}, {0.7, 0.7}, {0.3, 0.7}, {0.3, 0.3}});
    chains[0].jump = [](const Point&) { return 1.0; };
    chains[1].vertices = square.line({{0.1, 0.1}, {0.9, 0.1}});
    chains[1].left = chains[1].right = [](const Point&) { return 0.0; };
    Domain domain = square.domain(chains);
    const Eigen::VectorXd truth = fixtures::fem_solution(domain, fixtures::fem_stiffness(domain.surface));
    for (std::size_t c = 0; c < domain.couplings.size(); c += 3) {
        std::swap(domain.couplings[c].left, domain.couplings[c].right);
        domain.couplings[c].jump *= -1;
    }
    const Built built(std::move(domain), 0.05);
    // Short lists, so that many pairs on the curve are not listed.
    BasisTuning tuning;
    tuning.patch.list = 12;
    tuning.exact_knots = false;
    const Table table = local_basis(built.space, {.threads = 2}, tuning);
    const Eigen::VectorXd u = fixtures::evaluate(table, built.coefficients([&](int v) { return truth[v] > 0.5 ? 1.0 : 0.0; }));
    for (int v = 0; v < u.size(); ++v) EXPECT_NEAR(u[v], truth[v] > 0.5 ? 1.0 : 0.0, 2e-6);
}

TEST(BasisLaws, DirichletRowsAreTheirOwnKnot) {
    const Built& built = three_curves();
    const Table& t = built.table;
    for (std::uint32_t c = 0; c < t.cell_count; ++c) {
        const std::uint32_t stride = t.cell_first_index[c + 1] - t.cell_first_index[c];
        for (std::uint32_t row = t.cell_first_row[c]; row < t.cell_first_row[c + 1]; ++row) {
            const std::uint32_t vertex = t.row_vertex[row];
            if (!built.domain.dirichlet[vertex])
                continue;
            for (std::uint32_t e = 0; e < stride; ++e) {
                const float weight = t.weights[t.cell_first_weight[c] + (row - t.cell_first_row[c]) * stride + e];
                const bool own = static_cast<int>(t.indices[t.cell_first_index[c] + e]) == built.knots.knot_of_vertex[vertex];
                EXPECT_TRUE(weight == 0 || (own && weight == 1)) << "row " << row << " weight " << weight;
            }
        }
    }
}

TEST(BasisLaws, SupportEndsAtTheSecondRing) {
    const Built& built = three_curves();
    const Table& t = built.table;
    const auto ring = [&](const std::set<int>& cells) {
        std::set<int> more = cells;
        for (int c : cells)
            more.insert(built.space.neighbours.begin() + built.space.neighbour_first[c],
                        built.space.neighbours.begin() + built.space.neighbour_first[c + 1]);
        return more;
    };
    for (std::uint32_t c = 0; c < t.cell_count; ++c) {
        const std::set<int> near = ring(ring({static_cast<int>(c)}));
        for (std::uint32_t i = t.cell_first_index[c]; i < t.cell_first_index[c + 1]; ++i)
            EXPECT_TRUE(static_cast<int>(t.indices[i]) >= built.knot_count() || near.count(static_cast<int>(t.indices[i])))
                << "cell " << c;
    }
}

template <typename T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

TEST(BasisLaws, ThreadsChangeNoByte) {
    const Built& built = three_curves();
    for (int threads : {1, 3}) {
        const Table other = local_basis(built.space, {.threads = threads});
        EXPECT_TRUE(same_bytes(built.table.weights, other.weights));
        EXPECT_TRUE(same_bytes(built.table.indices, other.indices));
        EXPECT_TRUE(same_bytes(built.table.cell_first_weight, other.cell_first_weight));
        EXPECT_TRUE(same_bytes(built.table.row_vertex, other.row_vertex));
    }
}

TEST(BasisLaws, RotationAndScaleChangeNothing) {
    const Built& built = three_curves();
    Domain moved = built.domain;
    moved.surface = fixtures::scaled(fixtures::rotated(built.domain.surface, 1.1), 37);
    for (SourceColumn& source : moved.sources)
        for (auto& [face, laplacian] : source.profile) laplacian /= 37.0 * 37.0;
    const Table table = local_basis(PatchSpace(moved, built.knots, built.voronoi), {.threads = 2});
    fixtures::Random random(4);
    const Eigen::VectorXd coefficients = built.coefficients([&](int) { return random.real(-1, 1); });
    // Rough coefficients see every weight; float rounding times their number.
    EXPECT_LT((fixtures::evaluate(table, coefficients) - fixtures::evaluate(built.table, coefficients)).cwiseAbs().maxCoeff(),
              1e-5);
}

TEST(BasisLaws, SolutionsStayWithinTheirDirichletValues) {
    const Built built(fixtures::three_curves(80, false));
    const Eigen::MatrixXd lambda = built.lambda();
    const Eigen::VectorXd u = fixtures::evaluate(built.table, lambda.col(0));
    double low = 1e9, high = -1e9;
    for (int v = 0; v < u.size(); ++v)
        if (built.domain.dirichlet[v]) {
            low = std::min(low, built.domain.dirichlet_value(v, 0));
            high = std::max(high, built.domain.dirichlet_value(v, 0));
        }
    // One level of an 8-bit colour.
    EXPECT_GE(u.minCoeff(), low - 0.0039 * (high - low));
    EXPECT_LE(u.maxCoeff(), high + 0.0039 * (high - low));
}

struct Bars {
    double mean, max, h1, entries;
};

/// With lambda as a user gets it, and with lambda from the truth: the basis alone.
void expect_accurate(const Built& built, const Bars& solved, const Bars& basis_alone, const Eigen::SparseMatrix<double>& S) {
    const Eigen::VectorXd truth = fixtures::fem_solution(built.domain, S);
    const Eigen::MatrixXd lambda = built.lambda();
    for (const bool exact : {false, true}) {
        const Bars& bars = exact ? basis_alone : solved;
        const auto value = [&](int v) { return exact ? truth[v] : lambda(built.knots.knot_of_vertex[v], 0); };
        const fixtures::TableError error =
            fixtures::compare(built.domain, S, truth, fixtures::evaluate(built.table, built.coefficients(value)));
        EXPECT_LT(error.mean, bars.mean);
        EXPECT_LT(error.max, bars.max) << "at " << built.domain.surface.point(error.worst).transpose();
        EXPECT_LT(error.h1, bars.h1);
        std::printf("%8d vertices %6d knots  lambda %-6s mean %.4f  max %.3f  H1 %.2f  entries %.1f\n",
                    built.domain.surface.vertex_count(), built.knot_count(), exact ? "exact" : "solved", error.mean, error.max,
                    error.h1, fixtures::entries_per_vertex(built.domain, built.table));
    }
    EXPECT_LE(fixtures::entries_per_vertex(built.domain, built.table), solved.entries);
}

void expect_accurate(const Built& built, const Bars& solved, const Bars& basis_alone) {
    expect_accurate(built, solved, basis_alone, fixtures::fem_stiffness(built.domain.surface));
}

// Bars: two to four times what was measured, so that a change for the worse shows. The method's targets are 0.05, 0.39, 2, 24.
TEST(BasisAccuracy, ThreeCurvesAndABalancedRegion) {
    expect_accurate(Built(fixtures::three_curves(150)), {0.003, 0.04, 0.3, 24}, {0.0003, 0.04, 0.15, 24});
}
TEST(BasisAccuracy, CrossingsJumpAndChannels) {
    expect_accurate(Built(fixtures::crossings_and_jump(120)), {0.002, 0.06, 0.2, 24}, {0.0003, 0.1, 0.2, 24});
}
TEST(BasisAccuracy, SphereBand) {
    expect_accurate(Built(fixtures::sphere_band(20000).domain), {0.001, 0.06, 0.12, 24}, {0.0003, 0.06, 0.12, 24});
}

TEST(BasisAccuracy, DiscWithASource) {
    // u = 1 - r^2, the source everywhere: Green's columns carry it alone.
    expect_accurate(Built(fixtures::disk_domain(60)), {0.001, 0.01, 0.06, 24}, {0.001, 0.01, 0.06, 24});
}

TEST(BasisAccuracy, TrianglesThatAreNotDelaunay) {
    // Random diagonals with angles up to 150 degrees. The truth is that of the intrinsic Delaunay triangulation: on the obtuse
    // triangles as they are, linear elements themselves are 0.03 / 1.2 / 4.4 % away from it.
    const Built built(fixtures::three_curves(100, true, false));
    expect_accurate(built, {0.005, 0.1, 0.5, 24}, {0.0005, 0.1, 0.3, 24}, built.space.S);
}

TEST(Basis, TinyMeshes) {
    // A cuboid with one fixed edge, an icosahedron with one fixed vertex: patches that are the whole component.
    for (const Surface& surface : {fixtures::cuboid(), fixtures::icosphere(1), fixtures::plane(1, 1)}) {
        Domain domain = fixtures::plain_domain(surface);
        fixtures::fix(domain, 0, 1);
        const Built built(std::move(domain), 1);
        EXPECT_TRUE(validate(built.table).ok());
        Eigen::VectorXd ones = Eigen::VectorXd::Ones(built.table.coefficient_count);
        EXPECT_LT((fixtures::evaluate(built.table, ones).array() - 1).abs().maxCoeff(), 1e-6);
    }
}

TEST(Basis, OneRingWorksToo) {
    const Built& built = three_curves();
    const Table table = local_basis(built.space, {.rings = 1, .threads = 2});
    EXPECT_TRUE(validate(table).ok());
    EXPECT_LT(table.indices.size(), built.table.indices.size());
    const Eigen::SparseMatrix<double> S = fixtures::fem_stiffness(built.domain.surface);
    const Eigen::VectorXd truth = fixtures::fem_solution(built.domain, S);
    const auto error =
        fixtures::compare(built.domain, S, truth, fixtures::evaluate(table, built.coefficients([&](int v) { return truth[v]; })));
    EXPECT_LT(error.mean, 0.02);
    EXPECT_LT(error.max, 0.39);
}

}  // namespace
}  // namespace pvg
