// Poisson curves through the whole pipeline against closed forms: what stands inside, outside and between them.
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "convergence/measured.h"
#include "end_to_end/plane.h"
#include "fixtures/analytic.h"

namespace pvg::test {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double jump = 0.1;

const json bbox = {{"length_unit", "bbox"}};

json poisson_curve(const json& path, const json& height, double width = 0) {
    return {{"kind", "poisson_curve"}, {"path", path}, {"jump", {{"height", height}}}, {"width", width}};
}

/// Largest |height - expected| over the solved vertices where `expected` is a number, in units of the jump.
double worst(const Decorated& d, const std::function<double(const Point&)>& expected) {
    double most = 0;
    int vertices = 0;
    for (int v = 0; v < d.vertex_count(); ++v) {
        if (!d.reached(d.layer().height_domain, v))
            continue;
        const double wanted = expected(d.base(v));
        if (std::isnan(wanted))
            continue;
        const double error = std::abs(d.height(v) - wanted);
        EXPECT_TRUE(std::isfinite(error));
        most = std::max(most, error);
        ++vertices;
    }
    EXPECT_GT(vertices, 100);
    return most / jump;
}

constexpr double skip = std::numeric_limits<double>::quiet_NaN();

TEST(PoissonCurves, SharpOnADisk) {
    const Plane plane(20000);
    const double radius = 0.2;
    const Decorated d =
        decorate({plane.rim(0.45, {{"height", 0.0}}), poisson_curve(plane.circle(0, 0, radius), jump)}, plane.mesh, bbox);
    for (const bool inside : {true, false}) {
        const double error = worst(d, [&](const Point& p) {
            const double r = (p - plane.middle).norm();
            return (inside ? r > radius * 0.995 : r < radius * 1.005) ? skip : inside ? jump : 0.0;
        });
        std::printf("sharp, on a disk, %s: off by %.1e of the jump\n", inside ? "inside" : "outside", error);
        EXPECT_LT(error, 1e-5) << "the weights' single precision";
    }
}

TEST(PoissonCurves, WideOnADisk) {
    const Plane plane(20000);
    // Strips of 14, 7, 2.8, 1.7 and 0.8 edges of the mesh. What such narrow ones show inside themselves is the mesh's resolution:
    // the last two are held to what they leave beside them and to not overshooting.
    for (const auto& [radius, width, bar] :
         {std::array{0.2, 0.1, 0.8}, {0.2, 0.05, 0.8}, {0.1, 0.02, 5.0}, {0.1, 0.012, 100.0}, {0.1, 0.006, 100.0}}) {
        const Decorated d = decorate(
            {plane.rim(0.45, {{"height", 0.0}}), poisson_curve(plane.circle(0, 0, radius), jump, width / plane.diagonal)},
            plane.mesh, bbox);
        for (const bool inside : {true, false}) {
            const double error = worst(d, [&](const Point& p) {
                const double r = (p - plane.middle).norm();
                return (inside ? r > radius - width : r < radius + width) ? skip : inside ? jump : 0.0;
            });
            std::printf("radius %g, width %g, %s: off by %.1e of the jump\n", radius, width, inside ? "inside" : "outside",
                        error);
            EXPECT_LT(error, 1e-3);
        }
        double low = 0, high = 0;
        for (int v = 0; v < d.vertex_count(); ++v)
            if (d.reached(d.layer().height_domain, v)) {
                low = std::min(low, d.height(v) / jump);
                high = std::max(high, d.height(v) / jump);
            }
        std::printf("  between %.4f and %.4f of the jump\n", low, high);
        EXPECT_GT(low, -0.02);
        EXPECT_LT(high, 1.02);
        const analytic::DiskStep u{radius, width, jump};
        const Errors e = height_errors(d, jump, [&](const Point& p, int) { return u((p - plane.middle).norm()); });
        std::printf("  against the closed form: mean %.4f %%, max %.4f %%\n", e.mean, e.max);
        EXPECT_LT(e.mean, 0.1);
        EXPECT_LT(e.max, bar);
    }
}

TEST(PoissonCurves, OnASphere) {
    const ShapeMesh sphere = make_shape("sphere", 20000);
    const double radius = sphere.points.at(0).norm(), unit = 2 * std::sqrt(3.0) * radius;
    const auto circle = [&](double z, double angle) {
        return json{{"type", "circle"}, {"center", {0, 0, z}}, {"radius", radius * angle / unit}};
    };
    const double rim = 0.6, angle = 1.0, width = 0.15;
    for (const double w : {0.0, width}) {
        const json primitives = {{{"kind", "diffusion_curve"}, {"path", circle(-radius, rim)}, {"right", {{"height", 0.0}}}},
                                 poisson_curve(circle(radius, angle), jump, radius * w / unit)};
        const Decorated d = decorate(primitives, sphere, bbox);
        for (const bool inside : {true, false}) {
            const double error = worst(d, [&](const Point& p) {
                const double theta = std::acos(p[2] / p.norm());
                return (inside ? theta > angle - w - 0.002 : theta < angle + w + 0.002) ? skip : inside ? jump : 0.0;
            });
            std::printf("sphere, width %g, %s: off by %.1e of the jump\n", w, inside ? "inside" : "outside", error);
            EXPECT_LT(error, w > 0 ? 1e-3 : 1e-5);
        }
    }
}

TEST(PoissonCurves, TwoThatCrossAdd) {
    const Plane plane(20000);
    const double J1 = 0.1, J2 = 0.06, radius = 0.2, apart = 0.12;
    for (const double w : {0.0, 0.04}) {
        const Decorated d =
            decorate({plane.rim(0.45, {{"height", 0.0}}), poisson_curve(plane.circle(-apart, 0, radius), J1, w / plane.diagonal),
                      poisson_curve(plane.circle(apart, 0, radius), J2, w / plane.diagonal)},
                     plane.mesh, bbox);
        for (const int sector : {0, 1, 2, 3}) {
            const double error = worst(d, [&](const Point& p) {
                const double x = p[0] - plane.middle[0], y = p[1] - plane.middle[1];
                double sum = 0;
                int here = 0;
                for (const int k : {0, 1}) {
                    const double r = std::hypot(x - (k ? apart : -apart), y);
                    if (std::abs(r - radius) < w + 0.001)
                        return skip;
                    if (r < radius) {
                        here |= 1 << k;
                        sum += k ? J2 : J1;
                    }
                }
                return here == sector ? sum : skip;
            });
            std::printf("crossing, width %g, sector %d: off by %.1e of the jump\n", w, sector, error);
            EXPECT_LT(error, 1e-3);
        }
        if (w > 0) {
            const Errors e = height_errors(d, J1 + J2, [&](const Point& p, int) {
                const double x = p[0] - plane.middle[0], y = p[1] - plane.middle[1];
                return analytic::DiskStep{radius, w, J1}(std::hypot(x + apart, y)) +
                       analytic::DiskStep{radius, w, J2}(std::hypot(x - apart, y));
            });
            std::printf("  against the sum of the closed forms: mean %.4f %%, max %.4f %%\n", e.mean, e.max);
            EXPECT_LT(e.mean, 0.1);
            EXPECT_LT(e.max, 1.2);
        }
    }
}

TEST(PoissonCurves, WideAcrossARegion) {
    const Plane plane(20000);
    const double radius = 0.2, apart = 0.12, w = 0.04, border = 0.15;
    const json region = {
        {"kind", "poisson_region"}, {"path", plane.circle(apart, 0, border)}, {"rise", {{"height", jump}}}, {"ring", 0.2}};
    const Decorated d = decorate(
        {plane.rim(0.45, {{"height", 0.0}}), poisson_curve(plane.circle(-apart, 0, radius), jump, w / plane.diagonal), region},
        plane.mesh, bbox);
    const analytic::BalancedRegion bump{border, 0.8 * border, jump};
    const analytic::DiskStep step{radius, w, jump};
    const Errors e = height_errors(d, 2 * jump, [&](const Point& p, int) {
        const double x = p[0] - plane.middle[0], y = p[1] - plane.middle[1];
        return step(std::hypot(x + apart, y)) + bump(std::hypot(x - apart, y));
    });
    std::printf("wide across a region: mean %.4f %%, max %.4f %%\n", e.mean, e.max);
    EXPECT_LT(e.mean, 0.1);
    EXPECT_LT(e.max, 0.8);
    const double outside = worst(d, [&](const Point& p) {
        const double x = p[0] - plane.middle[0], y = p[1] - plane.middle[1];
        return std::hypot(x + apart, y) > radius + w && std::hypot(x - apart, y) > border ? 0.0 : skip;
    });
    std::printf("  outside both: off by %.1e of the jump\n", outside);
    EXPECT_LT(outside, 1e-3);
}

TEST(PoissonCurves, OpenWideOneIsTheSharpOneBesideItsStrips) {
    const double half = 0.45, reach = 0.2, w = 0.03;
    const auto height = [&](double x) { return jump * std::pow(std::cos(pi * std::clamp(x / reach, -1.0, 1.0) / 2), 2); };
    // Finely: a grid with the jump along its middle line, the stops' piecewise linear values.
    const int cells = 180, stops = 32;
    const auto piecewise = [&](double x) {
        const double t = std::clamp((x + reach) / (2 * reach), 0.0, 1.0) * stops, k = std::min(std::floor(t), stops - 1.0);
        const auto at = [&](double i) { return height(reach * (2 * i / stops - 1)); };
        return at(k) + (t - k) * (at(k + 1) - at(k));
    };
    std::vector<fixtures::Chain> chains(1);
    for (int i = 50; i <= 130; ++i) chains[0].vertices.push_back(90 * (cells + 1) + i);
    chains[0].jump = [&](const Point& p) { return piecewise(p.x() - half); };
    Domain domain = fixtures::slit_domain(fixtures::plane(cells, cells, 2 * half, 2 * half), chains);
    for (int v = 0; v < domain.surface.vertex_count(); ++v)
        if (const Point& p = domain.surface.point(v);
            p.x() < 1e-9 || p.y() < 1e-9 || p.x() > 2 * half - 1e-9 || p.y() > 2 * half - 1e-9)
            fixtures::fix(domain, v, 0);
    const Eigen::VectorXd solution = solve_finite_elements(fixtures::fem_problem(domain)).col(0);
    std::vector<double> grid((cells + 1) * (cells + 1));
    for (int v = 0; v < solution.size(); ++v) grid[domain.vertex_parent[v]] = solution[v];
    const auto reference = [&](double x, double y) {
        const double s = (x + half) / (2 * half) * cells, t = (y + half) / (2 * half) * cells;
        const int i = std::clamp(static_cast<int>(s), 0, cells - 1), j = std::clamp(static_cast<int>(t), 0, cells - 1);
        const double a = s - i, b = t - j;
        const double* at = &grid[j * (cells + 1) + i];
        return (1 - b) * ((1 - a) * at[0] + a * at[1]) + b * ((1 - a) * at[cells + 1] + a * at[cells + 2]);
    };

    const Plane plane(20000);
    json values = json::array();
    for (int k = 0; k <= stops; ++k)
        values.push_back({{"t", k / double(stops)}, {"height", height(reach * (2.0 * k / stops - 1))}});
    const json frame = {{"kind", "diffusion_curve"},
                        {"path", plane.polyline({{-half, -half}, {half, -half}, {half, half}, {-half, half}}, true)},
                        {"left", {{"height", 0.0}}}};
    json curve = poisson_curve(plane.polyline({{-reach, 0}, {reach, 0}}, false), 0.0, w / plane.diagonal);
    curve["jump"] = values;
    const Decorated d = decorate({frame, curve}, plane.mesh, bbox);
    const double error = worst(d, [&](const Point& p) {
        const double x = p[0] - plane.middle[0], y = p[1] - plane.middle[1];
        const double distance = std::hypot(std::max(0.0, std::abs(x) - reach), y);
        return distance < w * 1.01 ? skip : reference(x, y);
    });
    EXPECT_GT(reference(0, 0.05), 0.3 * jump);  // there is something to get right
    std::printf("open, width %g, beside its strips: off by %.1e of the jump\n", w, error);
    EXPECT_LT(error, 1e-3);
}

}  // namespace
}  // namespace pvg::test
