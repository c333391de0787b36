// The whole pipeline against closed-form solutions, at the default knot density. Errors are % of the solution's range
// (or of the peak); the bars are the project's acceptance figures.
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "end_to_end/plane.h"
#include "fixtures/analytic.h"

namespace pvg::test {
namespace {

constexpr double pi = std::numbers::pi;

void print(const char* name, const Errors& e, const Decorated& d) {
    std::size_t knots = 0;
    for (const auto& domain : d.build.domains) knots += domain.knots.vertex.size();
    std::printf("%s: mean %.4f %%, max %.4f %%, %d vertices, %zu knots\n", name, e.mean, e.max, e.vertices, knots);
}

TEST(Analytic, BandBetweenTwoCirclesOnASphere) {
    const ShapeMesh sphere = make_shape("sphere", 41000);
    const double radius = sphere.points.at(0).norm(), unit = 2 * std::sqrt(3.0) * radius;
    const double theta1 = pi / 3, theta2 = pi * 0.75;
    // Both circles run counter-clockwise around their poles: the band is on the right of each.
    const auto circle = [&](double z, double angle) {
        return json{{"type", "circle"}, {"center", {0, 0, z}}, {"radius", radius * angle / unit}};
    };
    const json primitives = {{{"kind", "diffusion_curve"}, {"path", circle(radius, theta1)}, {"right", {{"height", 0.0}}}},
                             {{"kind", "diffusion_curve"}, {"path", circle(-radius, pi - theta2)}, {"right", {{"height", 1.0}}}}};
    const Decorated d = decorate(primitives, sphere, {{"length_unit", "bbox"}});
    const analytic::SphereBand band{theta1, theta2};
    const Errors e = height_errors(d, 1.0, [&](const Point& p, int) { return band(std::acos(p[2] / p.norm())); });
    print("sphere band", e, d);
    EXPECT_GT(e.vertices, 20000);
    EXPECT_LE(e.mean, 0.1);
    EXPECT_LE(e.max, 0.8);
}

TEST(Analytic, DiskWithHarmonicRim) {
    const Plane plane(20000);
    const double radius = 0.4;
    json stops = json::array();
    for (int i = 0; i <= 128; ++i) stops.push_back({{"t", i / 128.0}, {"height", std::cos(2 * 2 * pi * i / 128.0)}});
    const Decorated d = decorate(json::array({plane.rim(radius, stops)}), plane.mesh, {{"length_unit", "bbox"}});
    const Errors e = height_errors(d, 2.0, [&](const Point& p, int) {
        return analytic::DiskHarmonic{2}((p[0] - plane.middle[0]) / radius, (p[1] - plane.middle[1]) / radius);
    });
    print("disk, harmonic rim", e, d);
    EXPECT_GT(e.vertices, 8000);
    EXPECT_LE(e.mean, 0.1);
    EXPECT_LE(e.max, 0.8);
}

TEST(Analytic, DiskWithPoissonRegionWithoutRing) {
    const Plane plane(20000);
    const double outer = 0.45, inner = 0.25, peak = 0.1, f = -4 * peak / (inner * inner);
    // The region's own problem (0 on its border) peaks at `rise`; here the rim at `outer` is what holds the field.
    const json region = {
        {"kind", "poisson_region"}, {"path", plane.circle(0, 0, inner)}, {"rise", {{"height", peak}}}, {"ring", "none"}};
    const Decorated d = decorate({plane.rim(outer, {{"height", 0.0}}), region}, plane.mesh, {{"length_unit", "bbox"}});
    const analytic::DiskInnerSource u{outer, inner, f};
    const Errors e = height_errors(d, u.peak(), [&](const Point& p, int) { return u((p - plane.middle).norm()); });
    print("disk, region without ring", e, d);
    EXPECT_LE(e.mean, 0.1);
    EXPECT_LE(e.max, 0.8);
}

TEST(Analytic, DiskWithBalancedPoissonRegion) {
    const Plane plane(20000);
    const double outer = 0.45, border = 0.3, ring = 0.2, peak = 0.1;
    const double r = (1 - ring) * border;
    const json region = {
        {"kind", "poisson_region"}, {"path", plane.circle(0, 0, border)}, {"rise", {{"height", peak}}}, {"ring", ring}};
    const Decorated d = decorate({plane.rim(outer, {{"height", 0.0}}), region}, plane.mesh, {{"length_unit", "bbox"}});
    const analytic::BalancedRegion u{border, r, peak};
    double outside = 0;
    const Errors e = height_errors(d, peak, [&](const Point& p, int v) {
        const double s = (p - plane.middle).norm();
        if (s > border * 1.001)
            outside = std::max(outside, std::abs(d.height(v)));
        return u(s);
    });
    print("disk, region with ring", e, d);
    std::printf("  outside the region at most %.4f %% of the peak\n", outside / peak * 100);
    EXPECT_LE(e.mean, 0.1);
    EXPECT_LE(e.max, 0.8);
    EXPECT_LE(outside / peak * 100, 0.3);
}

TEST(Analytic, OpenSlitHasItsSquareRoot) {
    const Plane plane(20000);
    const double radius = 0.4;
    json stops = json::array();
    for (int i = 0; i <= 128; ++i) stops.push_back({{"t", i / 128.0}, {"height", std::sin(pi * i / 128.0)}});
    const json slit = {
        {"kind", "diffusion_curve"}, {"path", plane.polyline({{0, 0}, {radius, 0}}, false)}, {"both", {{"height", 0.0}}}};
    const Decorated d = decorate({plane.rim(radius, stops), slit}, plane.mesh, {{"length_unit", "bbox"}});
    const Errors e = height_errors(d, 1.0, [&](const Point& p, int v) {
        const double x = (p[0] - plane.middle[0]) / radius, y = (p[1] - plane.middle[1]) / radius;
        if (d.build.arrangement.domains[d.layer().height_domain]
                .dirichlet[d.build.arrangement.domain_vertex[d.layer().height_domain][v]])
            return std::numeric_limits<double>::quiet_NaN();  // given, not solved for
        const double angle = std::atan2(y, x);
        return analytic::OpenSlit{1}(std::hypot(x, y), angle < 0 ? angle + 2 * pi : angle);
    });
    print("open slit", e, d);
    // The singular tip costs any linear element O(h^(1/2)) of its local scale, so the largest error stands there.
    EXPECT_LE(e.mean, 0.15);
    EXPECT_LE(e.max, 2.2);
}

/// Largest |height| outside a closed region, % of the largest inside.
double leak(const Plane& plane, const json& path, const json& ring, double slack,
            const std::function<double(double, double)>& distance_outside) {
    const json region = {{"kind", "poisson_region"}, {"path", path}, {"rise", {{"height", 0.1}}}, {"ring", ring}};
    const Decorated d = decorate({plane.rim(0.47, {{"height", 0.0}}), region}, plane.mesh, {{"length_unit", "bbox"}});
    double outside = 0, top = 0;
    for (int v = 0; v < d.vertex_count(); ++v) {
        if (!d.reached(d.layer().height_domain, v))
            continue;
        const double height = std::abs(d.height(v));
        top = std::max(top, height);
        if (distance_outside(d.base(v)[0] - plane.middle[0], d.base(v)[1] - plane.middle[1]) > slack)
            outside = std::max(outside, height);
    }
    EXPECT_NEAR(top, 0.1, 0.003);
    return outside / top * 100;
}

TEST(Analytic, SquareRegionIsFlatOutside) {
    const Plane plane(20000);
    const double half = 0.2;
    const double percent = leak(plane, plane.polyline({{-half, -half}, {half, -half}, {half, half}, {-half, half}}, true), 0.2,
                                0.001, [&](double x, double y) { return std::max(std::abs(x), std::abs(y)) - half; });
    std::printf("square region: outside at most %.4f %% of the peak\n", percent);
    EXPECT_LE(percent, 0.3);
}

TEST(Analytic, ThinStrokeIsFlatOutside) {
    const Plane plane(20000);
    const double percent = leak(plane, plane.polyline({{-0.3, -0.03}, {0.3, -0.03}, {0.3, 0.03}, {-0.3, 0.03}}, true), 0.2, 0.001,
                                [&](double x, double y) { return std::max(std::abs(x) - 0.3, std::abs(y) - 0.03); });
    std::printf("thin stroke 10:1: outside at most %.4f %% of the peak\n", percent);
    EXPECT_LE(percent, 0.3);
}

TEST(Slits, TwoSidedCurveOnASphereGivesExactlyTwoColours) {
    const ShapeMesh sphere = make_shape("sphere", 10000);
    const double radius = sphere.points.at(0).norm();
    const json curve = {
        {"kind", "diffusion_curve"},
        {"path",
         {{"type", "circle"}, {"center", {0.1 * radius, 0.2 * radius, std::sqrt(0.95) * radius}}, {"radius", 0.7 * radius}}},
        {"left", {{"color", {1, 0, 0}}}},
        {"right", {{"color", {0, 0, 1}}}}};
    const Decorated d = decorate(json::array({curve}), sphere);
    const Surface& surface = d.build.arrangement.output;
    const int domain = d.layer().color_domain;
    std::vector<int> side(d.vertex_count(), 0);
    int red = 0, blue = 0;
    for (int v = 0; v < d.vertex_count(); ++v) {
        ASSERT_TRUE(d.reached(domain, v));
        const double r = d.value(domain, 0, v), b = d.value(domain, 2, v);
        // Weights sum to 1 in single precision, so a constant field is met to a few units in the last place.
        const bool is_red = std::abs(r - 1) < 1e-5 && std::abs(b) < 1e-5, is_blue = std::abs(r) < 1e-5 && std::abs(b - 1) < 1e-5;
        ASSERT_TRUE(is_red != is_blue) << "vertex " << v << ": r " << r << ", b " << b;
        side[v] = is_red ? 1 : 2;
        ++(is_red ? red : blue);
    }
    EXPECT_GT(red, 500);
    EXPECT_GT(blue, 500);
    for (const Face& face : surface.faces()) EXPECT_TRUE(side[face[0]] == side[face[1]] && side[face[1]] == side[face[2]]);
    EXPECT_NEAR(surface.area() / d.build.welded.surface.area(), 1, 1e-6);
}

TEST(Slits, ColourAndHeightCurvesThatCrossDoNotCutEachOther) {
    const Plane plane(8000);
    const json frame = {
        {"kind", "diffusion_curve"}, {"path", plane.circle(0, 0, 0.45)}, {"left", {{"color", {1, 1, 1}}, {"height", 0.0}}}};
    const json height = {{"kind", "diffusion_curve"}, {"path", plane.circle(-0.08, 0, 0.2)}, {"both", {{"height", 0.1}}}};
    const json colour = {{"kind", "diffusion_curve"},
                         {"path", plane.circle(0.08, 0, 0.2)},
                         {"left", {{"color", {1, 0, 0}}}},
                         {"right", {{"color", {0, 0, 1}}}}};
    const Decorated both = decorate({frame, height, colour}, plane.mesh, {{"length_unit", "bbox"}});
    const Decorated alone = decorate({frame, height}, plane.mesh, {{"length_unit", "bbox"}});

    // Across the colour curve the two copies of a vertex have one height, across the height curve one colour.
    const Arrangement& a = both.build.arrangement;
    ASSERT_NE(a.layers[0].color_domain, a.layers[0].height_domain);
    std::vector<int> first(a.imprinted.surface.vertex_count(), none);
    int colour_copies = 0, height_copies = 0;
    for (int v = 0; v < both.vertex_count(); ++v) {
        if (!both.reached(a.layers[0].color_domain, v) || !both.reached(a.layers[0].height_domain, v))
            continue;
        int& other = first[a.output_parent[v]];
        if (other == none) {
            other = v;
            continue;
        }
        const bool same_colour = a.domain_vertex[a.layers[0].color_domain][v] == a.domain_vertex[a.layers[0].color_domain][other];
        const bool same_height =
            a.domain_vertex[a.layers[0].height_domain][v] == a.domain_vertex[a.layers[0].height_domain][other];
        colour_copies += !same_colour && same_height;
        height_copies += same_colour && !same_height;
    }
    EXPECT_GT(colour_copies, 50);
    EXPECT_GT(height_copies, 50);

    // And the height is what it is without the colour curve (to the accuracy of two different knot sets), inside a constant.
    for (int v = 0; v < both.vertex_count(); ++v) {
        if (!both.reached(a.layers[0].height_domain, v))
            continue;
        const double r = std::hypot(both.base(v)[0] - plane.middle[0] + 0.08, both.base(v)[1] - plane.middle[1]);
        if (r < 0.199) {
            EXPECT_NEAR(both.height(v), 0.1, 1e-6);
        }
    }
    double sum_both = 0, sum_alone = 0;
    const std::vector<double> areas_both = both.vertex_areas(), areas_alone = alone.vertex_areas();
    for (int v = 0; v < both.vertex_count(); ++v)
        if (both.reached(a.layers[0].height_domain, v))
            sum_both += areas_both[v] * both.height(v);
    for (int v = 0; v < alone.vertex_count(); ++v)
        if (alone.reached(alone.layer().height_domain, v))
            sum_alone += areas_alone[v] * alone.height(v);
    EXPECT_NEAR(sum_both / sum_alone, 1, 2e-3);
}

}  // namespace
}  // namespace pvg::test
