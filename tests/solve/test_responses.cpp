// New values of controls: the responses against a fresh solve of the same numbers, and the laws of a linear map.
#include "solve/responses.h"

#include <random>

#include <gtest/gtest.h>

#include "curves/controls.h"
#include "curves/edge_drawing.h"
#include "solve/basis.h"
#include "solve/bounds.h"
#include "solve/field.h"
#include "solve/galerkin.h"

namespace pvg {
namespace {

constexpr int n = 24;
constexpr GalerkinOptions exact{.max_steps = 400, .reduction = 1e-9, .settled = 0, .bounded = false};

int at(int x, int y) { return y * (n + 1) + x; }

/// Colour and height in one domain: a closed curve with stops, an open one, a sharp jump that fades, a region.
test::EdgeScene scene_of_all_parts() {
    test::EdgeScene scene(fixtures::plane(n, n));
    SideValues stops{{{0, 0.3, 0.7}, {test::red, test::green, test::blue}}, {{0, 0.3, 0.7}, {0.1, 0.2, -0.1}}};
    std::vector<int> ring;
    for (int x = 6; x < 18; ++x) ring.push_back(at(x, 6));
    for (int y = 6; y < 18; ++y) ring.push_back(at(18, y));
    for (int x = 18; x > 6; --x) ring.push_back(at(x, 18));
    for (int y = 18; y > 6; --y) ring.push_back(at(6, y));
    scene.dc(stops, {{{0}, {test::white}}, {{0}, {0.0}}}, ring, true);
    scene.dc({{{0}, {test::blue}}, {{0}, {0.3}}}, {{{0, 1}, {test::red, test::green}}, {{0, 1}, {0.0, 0.1}}},
             test::grid_line(n, 2, 2, 2, 20));
    PoissonCurve jump;
    jump.color_jump = {{0, 0.5, 1}, {Color::Zero(), Color(0.4, -0.2, 0.1, 0), Color::Zero()}};
    jump.height_jump = {{0, 0.5, 1}, {0.0, 0.2, 0.0}};
    scene.add(jump, test::grid_line(n, 9, 9, 9, 15));
    PoissonRegion region;
    region.color = Color(1, 2, -1, 0);
    region.height = -1;
    const int bump = scene.add(region, {at(12, 9), at(15, 9), at(15, 12), at(12, 12)}, true);
    std::vector<std::pair<int, double>> profile;
    for (int f = 0; f < scene.surface().face_count(); ++f) {
        Point centre = Point::Zero();
        for (int v : scene.surface().face(f)) centre += scene.surface().point(v) / 3;
        const double size = scene.surface().point(at(n, n))[0] / n;
        if (centre[0] > 12 * size && centre[0] < 15 * size && centre[1] > 9 * size && centre[1] < 12 * size)
            profile.emplace_back(f, 1.0);
    }
    scene.source(bump, std::move(profile));
    return scene;
}

class ResponsesTest : public testing::Test {
protected:
    ResponsesTest()
        : arrangement(scene_of_all_parts().arrange()),
          domain(arrangement.domains.at(0)),
          knots(place_knots(domain, {.spacing = 0.06 * domain.surface.diagonal()})),
          voronoi(geodesic_voronoi(domain, knots)),
          space(domain, knots, voronoi),
          system(domain, knots, voronoi),
          table(local_basis(space, {.threads = 2})),
          matrix(galerkin_matrix(space, table, static_cast<int>(knots.vertex.size()), 2)),
          unbounded(solve(domain)),
          responses(domain, knots, system, matrix, table, unbounded) {}

    Eigen::MatrixXd solve(const Domain& d) const {
        Eigen::MatrixXd lambda = system.solve(d);
        minimise_energy(matrix, system, given_values(d, knots.vertex).source, exact, lambda);
        return lambda;
    }
    /// From a solve of its own, bounds as a build has them.
    std::vector<float> fresh(const std::vector<Control>& controls) const {
        Domain changed = domain;
        changed.controls = controls;
        apply_controls(changed);
        Eigen::MatrixXd lambda = solve(changed);
        keep_between_bounds(changed, knots, lambda);
        return coefficient_values(lambda, given_values(changed, knots.vertex).source);
    }
    std::vector<Control> random_controls(unsigned seed) const {
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> in(-1, 1);
        std::vector<Control> controls = domain.controls;
        for (Control& c : controls)
            for (Eigen::Index s = 0; s < c.value.rows(); ++s)
                for (Eigen::Index k = 0; k < c.value.cols(); ++k)
                    if (c.value.col(k).any())
                        c.value(s, k) = in(random);
        return controls;
    }
    static double apart(const std::vector<float>& a, const std::vector<float>& b) {
        EXPECT_EQ(a.size(), b.size());
        double most = 0;
        for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(double{a[i]} - b[i]));
        return most;
    }

    Arrangement arrangement;
    const Domain& domain;
    Knots knots;
    Voronoi voronoi;
    PatchSpace space;
    System system;
    Table table;
    GalerkinMatrix matrix;
    Eigen::MatrixXd unbounded;
    Responses responses;
};

TEST_F(ResponsesTest, FixtureHasEveryPartInOneDomain) {
    ASSERT_EQ(arrangement.domains.size(), 1u);
    EXPECT_EQ(domain.channels, 5);
    EXPECT_EQ(domain.controls.size(), 12u);  // two curves of two sides, a jump, a region; each colour and height
    EXPECT_FALSE(domain.couplings.empty());
    EXPECT_EQ(domain.sources.size(), 1u);
}

TEST_F(ResponsesTest, ControlsSayWhatTheDomainHolds) {
    Domain again = domain;
    again.dirichlet_value.setZero();
    for (Coupling& c : again.couplings) c.jump.setZero();
    for (SourceColumn& s : again.sources) s.value.setZero();
    apply_controls(again);
    EXPECT_EQ(again.dirichlet_value, domain.dirichlet_value);
    for (std::size_t c = 0; c < domain.couplings.size(); ++c) EXPECT_EQ(again.couplings[c].jump, domain.couplings[c].jump);
    EXPECT_EQ(again.sources[0].value, domain.sources[0].value);
    EXPECT_GT(domain.dirichlet_value.cwiseAbs().maxCoeff(), 0.5);
}

TEST_F(ResponsesTest, NewValuesGiveWhatASolveGives) {
    for (unsigned seed = 1; seed <= 4; ++seed) {
        const std::vector<Control> controls = random_controls(seed);
        EXPECT_LT(apart(responses.coefficients(controls), fresh(controls)), 3e-6) << seed;
    }
}

TEST_F(ResponsesTest, MovedStopsGiveWhatASolveGives) {
    std::vector<Control> controls = random_controls(7);
    for (Control& c : controls)
        if (c.closed && c.t.size() == 3) {
            c.t = {0.1, 0.2};
            c.value.conservativeResize(2, Eigen::NoChange);
        }
    EXPECT_LT(apart(responses.coefficients(controls), fresh(controls)), 3e-6);
}

TEST_F(ResponsesTest, OldValuesGiveTheFirstCoefficientsWhateverCameBefore) {
    const std::vector<float> first = responses.coefficients(domain.controls);
    EXPECT_EQ(responses.prepare({}), 0);
    const std::vector<float> one = responses.coefficients(random_controls(1));
    EXPECT_NE(one, first);
    responses.coefficients(random_controls(2));
    EXPECT_EQ(responses.coefficients(random_controls(1)), one);
    EXPECT_EQ(responses.coefficients(domain.controls), first);
}

TEST_F(ResponsesTest, ColourAndHeightShareColumnsAndNoneIsSolvedTwice) {
    int stops = 0;
    for (const Control& c : domain.controls) stops += static_cast<int>(c.t.size());
    EXPECT_EQ(responses.prepare_all(), stops / 2);
    EXPECT_EQ(responses.prepare_all(), 0);
}

TEST_F(ResponsesTest, OneColourEverywhereIsThatColourExactly) {
    std::vector<Control> controls = domain.controls;
    const Eigen::RowVectorXd color = (Eigen::RowVectorXd(5) << 0.3, 0.6, 0.1, 1, 0).finished();
    for (Control& c : controls) {
        c.value.setZero();
        if (c.part <= ControlPart::right && c.quantity == Quantity::color)
            c.value.rowwise() = color;
    }
    const std::vector<float>& all = responses.coefficients(controls);
    for (std::size_t j = 0; j < knots.vertex.size(); ++j)
        for (int c = 0; c < 5; ++c) EXPECT_EQ(all[5 * j + c], static_cast<float>(color[c]));
}

}  // namespace
}  // namespace pvg
