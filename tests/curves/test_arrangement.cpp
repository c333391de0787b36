// Scenes arranged from beginning to end: paths traced, imprinted, slit; regions and strips against formulas and a plain
// finite-element solution.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "curves/arrangement.h"
#include "pvg/status.h"
#include "scene_drawing.h"

namespace pvg::test {
namespace {

const Surface& flat() {
    static const Surface surface = fixtures::irregular_plane(60, 60);
    return surface;
}
/// A plane with a height-0 curve around it.
const json ground = height_curve(rim(1), 0, nullptr);

std::string error_of(const Surface& surface, const json& primitives, const std::function<void(BaseSurface&)>& change = {}) {
    const Scene scene = scene_of(primitives);
    BaseSurface base = base_of(surface);
    if (change)
        change(base);
    Warnings warnings;
    try {
        arrange(scene, base, warnings);
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::bad_input);
        return error.what();
    }
    return "";
}

json region(const json& path, const json& more) {
    json primitive = {{"kind", "poisson_region"}, {"path", path}};
    primitive.update(more);
    return primitive;
}

/// Largest |u| among the vertices that `inside` accepts or not, as shares of the largest of all.
std::pair<double, double> peak_and_outside(const Domain& domain, const Eigen::VectorXd& u,
                                           const std::function<bool(const Point&)>& inside) {
    double peak = 0, outside = 0;
    for (int v = 0; v < u.size(); ++v) {
        peak = std::max(peak, std::abs(u[v]));
        if (!inside(domain.surface.point(v)))
            outside = std::max(outside, std::abs(u[v]));
    }
    return {peak, outside / peak};
}

TEST(Arrangement, RedAndBlueOnASphereAreExactAtTheCurve) {
    const Surface sphere = fixtures::icosphere(16);
    const Arranged a = arranged(sphere, json::array({{{"kind", "diffusion_curve"},
                                                      {"path", circle(0, 0, 1, 0.7)},
                                                      {"left", {{"color", "#ff0000"}}},
                                                      {"right", {{"color", "#0000ff"}}}}}));
    ASSERT_EQ(a.result.domains.size(), 1u);
    const Domain& d = a.result.domains[0];
    EXPECT_NEAR(a.result.output.area(), sphere.area(), 1e-6 * sphere.area());
    const Eigen::MatrixXd u = solve_plainly(d);
    int reds = 0, blues = 0;
    for (int v = 0; v < a.result.output.vertex_count(); ++v) {
        const int vertex = a.result.domain_vertex[0][v];
        ASSERT_NE(vertex, none);
        const Color c = u.row(vertex).transpose();
        const bool is_red = (c - red).norm() < 1e-9, is_blue = (c - blue).norm() < 1e-9;
        EXPECT_TRUE(is_red || is_blue) << c.transpose();
        if (d.dirichlet[vertex]) {
            EXPECT_TRUE(Color(d.dirichlet_value.row(vertex).transpose()) == red ||
                        Color(d.dirichlet_value.row(vertex).transpose()) == blue);
        }
        reds += is_red;
        blues += is_blue;
        // The circle is counter-clockwise seen from outside, so its inside, the cap around +z, is on the left.
        const Point& p = a.result.output.point(v);
        if (!d.dirichlet[vertex]) {
            EXPECT_EQ(is_red, p[2] > std::cos(0.7));
        }
    }
    EXPECT_GT(reds, 20);
    EXPECT_GT(blues, 20);
    // No triangle has both: faces share no vertex across the curve.
    for (const Face& face : a.result.output.faces())
        EXPECT_EQ((u.row(a.result.domain_vertex[0][face[0]]) - u.row(a.result.domain_vertex[0][face[1]])).norm() < 1e-9, true);
}

TEST(Arrangement, AColourCircleAndAHeightCircleDoNotSlitEachOther) {
    const Arranged a = arranged(
        flat(), json::array({{{"kind", "diffusion_curve"}, {"path", circle(0.4, 0.5, 0.2)}, {"both", {{"color", "#ff0000"}}}},
                             height_curve(circle(0.6, 0.5, 0.2), 1, 2)}));
    ASSERT_EQ(a.result.domains.size(), 2u);
    const Domain& color = a.result.domains[a.result.layers[0].color_domain];
    const Domain& height = a.result.domains[a.result.layers[0].height_domain];
    int doubled_color = 0, doubled_height = 0;
    for (const auto& [domain, center, count] :
         {std::tuple{&color, 0.4, &doubled_color}, std::tuple{&height, 0.6, &doubled_height}}) {
        std::vector<int> copies(a.result.imprinted.surface.vertex_count(), 0);
        for (int parent : domain->vertex_parent) ++copies[parent];
        for (int v = 0; v < static_cast<int>(copies.size()); ++v) {
            EXPECT_GE(copies[v], 1);
            if (copies[v] < 2)
                continue;
            ++*count;
            EXPECT_NEAR((a.result.imprinted.surface.point(v) - Point(center, 0.5, 0)).norm(), 0.2,
                        0.002);  // 0.05 of the shortest edge: snapping
        }
    }
    EXPECT_GT(doubled_color, 30);
    EXPECT_GT(doubled_height, 30);
}

TEST(Arrangement, EdgeLengthsAreTheInputsNotTheSlivers) {
    const Surface regular = fixtures::plane(20, 20);
    const Arranged a = arranged(regular, json::array({height_curve(circle(0.5, 0.5, 0.3), 1, 2)}));
    for (double length : a.result.domains.at(0).edge_length) {
        EXPECT_GT(length, 0.049);
        EXPECT_LT(length, 0.05 * std::sqrt(2.0));
    }
}

TEST(Arrangement, StopsBecomeVertices) {
    const json stops = {{{"t", 0}, {"height", 0}}, {{"t", 0.3}, {"height", 1}}, {{"t", 1}, {"height", 0}}};
    json curve = {{"kind", "diffusion_curve"}, {"path", polyline({{0, 0, 0}, {1, 0, 0}})}, {"left", stops}};
    const Arranged a = arranged(fixtures::plane(1, 1), json::array({curve}));
    const Domain& d = a.result.domains.at(0);
    EXPECT_NEAR(d.dirichlet_value.col(0).maxCoeff(), 1, 1e-12);
}

TEST(Regions, IntegrateToZeroAndKeepTheirAreas) {
    const json primitives =
        json::array({ground, region(circle(0.5, 0.5, 0.3), {{"laplacian", {{"height", 1}}}}),
                     region(circle(0.6, 0.5, 0.15), {{"laplacian", {{"height", 1}}}}),                   // nested
                     region(circle(0.8, 0.7, 0.15), {{"laplacian", {{"height", 1}}}, {"ring", 0.4}})});  // overlapping
    const Arranged a = arranged(flat(), primitives);
    const Domain& d = a.result.domains.at(0);
    ASSERT_EQ(d.sources.size(), 3u);
    const std::array<double, 3> radius{0.3, 0.15, 0.15};
    for (int i = 0; i < 3; ++i) {
        const auto [sum, size] = integral(d, d.sources[i]);
        EXPECT_LT(std::abs(sum), 1e-9 * size);
        double area = 0;
        for (const auto& [f, value] : d.sources[i].profile) area += d.surface.face_area(f);
        // The imprinted polygon's chords are within 0.1 % of the radius: areas within 0.3 %.
        EXPECT_NEAR(area, std::numbers::pi * radius[i] * radius[i], 0.003 * area);
    }
}

TEST(Regions, LaplacianIsPerLengthUnitSquared) {
    // In bounding-box units the disk's Laplacian is f / diagonal^2 per mesh unit.
    const json primitives = json::array(
        {ground, region(circle(0.5, 0.5, 0.3 / std::sqrt(2.0)), {{"laplacian", {{"height", -8}}}, {"ring", "none"}})});
    const Arranged a = arranged(flat(), primitives, {{"length_unit", "bbox"}});
    const Domain& d = a.result.domains.at(0);
    ASSERT_EQ(d.sources.size(), 1u);
    for (const auto& [f, value] : d.sources[0].profile) EXPECT_NEAR(value * d.sources[0].value(0), -4, 1e-12);
}

TEST(Regions, RiseOfADiskIsTheFormulas) {
    const double R = 0.3, h = 0.1;
    for (const double ring : {0.2, 0.4, 0.0}) {
        json more = {{"rise", {{"height", h}}}};
        if (ring > 0)
            more["ring"] = ring;
        else
            more["ring"] = "none";
        const Arranged a = arranged(flat(), json::array({ground, region(circle(0.5, 0.5, R), more)}));
        const Domain& d = a.result.domains.at(0);
        const SourceColumn& column = d.sources.at(0);
        const double r = (1 - ring) * R;
        const double expected = ring > 0 ? -2 * h * (R * R - r * r) / (r * r * R * R * std::log(R / r)) : -4 * h / (R * R);
        double inner = 0, inner_area = 0;
        for (const auto& [f, value] : column.profile)
            if (value * column.value(0) < 0) {
                inner += value * column.value(0) * d.surface.face_area(f);
                inner_area += d.surface.face_area(f);
            }
        EXPECT_NEAR(inner / inner_area, expected, 0.01 * std::abs(expected))
            << ring;  // 18 edges a radius: elements of 1st order, r to 0.3 %
        if (ring == 0)
            continue;
        const Eigen::MatrixXd u = solve_plainly(d);
        const auto [peak, outside] =
            peak_and_outside(d, u.col(0), [&](const Point& p) { return (p - Point(0.5, 0.5, 0)).norm() < R + 1e-9; });
        EXPECT_NEAR(peak, h, 0.005 * h) << ring;
        EXPECT_GT(u.maxCoeff(), 0.99 * h);  // a positive rise goes up
        EXPECT_LT(outside, 0.003) << ring;
    }
}

TEST(Regions, ASquareIsFlatOutside) {
    const Arranged a = arranged(
        flat(), json::array({ground, region(polyline({{0.25, 0.25, 0}, {0.75, 0.25, 0}, {0.75, 0.75, 0}, {0.25, 0.75, 0}}, true),
                                            {{"rise", {{"height", 1}}}})}));
    const Eigen::MatrixXd u = solve_plainly(a.result.domains.at(0));
    const auto [peak, outside] = peak_and_outside(a.result.domains[0], u.col(0), [](const Point& p) {
        return (p - Point(0.5, 0.5, 0)).cwiseAbs().maxCoeff() < 0.25 + 1e-9;
    });
    EXPECT_NEAR(peak, 1, 0.005);
    EXPECT_LT(outside, 0.003);
}

TEST(Regions, InsideOneHugeTriangle) {
    // No vertex lies off the border before the ring is drawn: what is inside must be measured in the faces.
    const double radius = 0.1;
    const Arranged a = arranged(
        fixtures::plane(1, 1),
        json::array({height_curve(circle(0.7, 0.3, 0.2), 0, 0), region(circle(0.7, 0.3, radius), {{"rise", {{"height", 1}}}})}));
    const Surface& surface = a.result.imprinted.surface;
    int on_inner = 0;
    for (const Point& p : surface.points()) on_inner += std::abs((p - Point(0.7, 0.3, 0)).norm() - 0.8 * radius) < 0.005 * radius;
    EXPECT_GT(on_inner, 20);
    EXPECT_LT(surface.vertex_count(), 1000);
    EXPECT_GT(solve_plainly(a.result.domains.at(0)).maxCoeff(), 0.9);
}

TEST(Regions, AThinStrokeIsFlatOutside) {
    // 10 : 1, one input edge a ring.
    const Surface fine = fixtures::irregular_plane(100, 100);
    const Arranged a = arranged(
        fine, json::array({ground, region(polyline({{0.1, 0.45, 0}, {0.9, 0.45, 0}, {0.9, 0.55, 0}, {0.1, 0.55, 0}}, true),
                                          {{"rise", {{"height", 1}}}})}));
    const Eigen::MatrixXd u = solve_plainly(a.result.domains.at(0));
    const auto [peak, outside] = peak_and_outside(a.result.domains[0], u.col(0), [](const Point& p) {
        return std::abs(p[0] - 0.5) < 0.4 + 1e-9 && std::abs(p[1] - 0.5) < 0.05 + 1e-9;
    });
    EXPECT_NEAR(peak, 1, 0.005);
    EXPECT_LT(outside, 0.003);
}

TEST(Regions, AreOnTheirOwnUndividedRegionAcrossADiffusionCurve) {
    // The same region with and without a curve through it has the same sources.
    const json bump = region(circle(0.5, 0.5, 0.25), {{"laplacian", {{"height", 1}}}});
    const json across = height_curve(polyline({{0.1, 0.52, 0}, {0.9, 0.52, 0}}), 1, 1);
    const Arranged with = arranged(flat(), json::array({ground, across, bump})),
                   without = arranged(flat(), json::array({ground, bump}));
    const auto positive = [](const Arranged& a) {
        const Domain& d = a.result.domains.at(0);
        double sum = 0;
        for (const auto& [f, value] : d.sources.at(0).profile) sum += std::max(0.0, value) * d.surface.face_area(f);
        const auto [total, size] = integral(d, d.sources[0]);
        EXPECT_LT(std::abs(total), 1e-9 * size);
        return sum;
    };
    EXPECT_NEAR(positive(with), positive(without),
                2e-3 * positive(without));  // the inner border's chords differ where the curve splits faces
    // The Laplacian stands on both sides of the curve.
    const Domain& d = with.result.domains[0];
    bool above = false, below = false;
    for (const auto& [f, value] : d.sources[0].profile) {
        const double y = (d.surface.point(d.surface.face(f)[0])[1] + d.surface.point(d.surface.face(f)[1])[1] +
                          d.surface.point(d.surface.face(f)[2])[1]) /
                         3;
        (y > 0.52 ? above : below) = true;
    }
    EXPECT_TRUE(above && below);
}

TEST(Strips, AClosedCurveLeavesTheOutsideUntouched) {
    const double R = 0.2, w = 0.06;
    const Arranged a = arranged(
        fixtures::irregular_plane(100, 100),
        json::array(
            {ground, {{"kind", "poisson_curve"}, {"path", circle(0.5, 0.5, R)}, {"jump", {{"height", 1}}}, {"width", w}}}));
    const Domain& d = a.result.domains.at(0);
    ASSERT_EQ(d.sources.size(), 1u);
    EXPECT_TRUE(d.couplings.empty());
    const auto [sum, size] = integral(d, d.sources[0]);
    EXPECT_LT(std::abs(sum), 1e-9 * size);
    const Eigen::MatrixXd u = solve_plainly(d);
    double outside = 0, inside = 0;
    for (int v = 0; v < d.surface.vertex_count(); ++v) {
        const double r = (d.surface.point(v) - Point(0.5, 0.5, 0)).norm();
        // One input edge beyond the strips' borders, where what is finer than the mesh has died out.
        if (r > R + w + 0.01)
            outside = std::max(outside, std::abs(u(v, 0)));
        if (r < R - w - 0.01)
            inside = std::max(inside, std::abs(u(v, 0) - 1));
    }
    EXPECT_LT(outside, 1e-3);
    EXPECT_LT(inside, 2e-3);
}

TEST(Strips, FollowTheFormulaOnAStraightCurve) {
    // From border to border: no ends. f = -J / w^2 on the left, +J / w^2 on the right.
    const double w = 0.08, J = 2;
    const Arranged a = arranged(flat(), json::array({ground,
                                                     {{"kind", "poisson_curve"},
                                                      {"path", polyline({{0, 0.5, 0}, {1, 0.5, 0}})},
                                                      {"jump", {{"height", J}}},
                                                      {"width", w}}}));
    const Domain& d = a.result.domains.at(0);
    double left = 0, right = 0, left_area = 0, right_area = 0;
    for (const auto& [f, value] : d.sources.at(0).profile) {
        const Face& face = d.surface.face(f);
        const double y = (d.surface.point(face[0])[1] + d.surface.point(face[1])[1] + d.surface.point(face[2])[1]) / 3;
        EXPECT_LT(std::abs(y - 0.5), w * 1.01);
        (y > 0.5 ? left : right) += value * J * d.surface.face_area(f);
        (y > 0.5 ? left_area : right_area) += d.surface.face_area(f);
    }
    EXPECT_NEAR(left_area, w, 0.005 * w);
    // Levelling spends 1.4 % of f here on what this mesh's triangles would let out.
    EXPECT_NEAR(left / left_area, -J / (w * w), 0.02 * J / (w * w));
    EXPECT_NEAR(right / right_area, J / (w * w), 0.02 * J / (w * w));
}

TEST(Strips, OneColumnAStop) {
    const json jump = {{{"t", 0}, {"height", 0}}, {{"t", 0.5}, {"height", 1}}, {{"t", 1}, {"height", 0}}};
    const Arranged a = arranged(
        flat(),
        json::array(
            {ground,
             {{"kind", "poisson_curve"}, {"path", polyline({{0.3, 0.5, 0}, {0.7, 0.5, 0}})}, {"jump", jump}, {"width", 0.05}}}));
    const Domain& d = a.result.domains.at(0);
    ASSERT_EQ(d.sources.size(), 3u);
    EXPECT_EQ(d.sources[1].value(0), 1);
    for (const SourceColumn& column : d.sources) {
        const auto [sum, size] = integral(d, column);
        EXPECT_LT(std::abs(sum), 1e-9 * size);
    }
    // The middle steps up by 1, left (north) over right.
    const Eigen::MatrixXd u = solve_plainly(d);
    const double north = u(fixtures::nearest_vertex(d.surface, Point(0.5, 0.55, 0)), 0),
                 south = u(fixtures::nearest_vertex(d.surface, Point(0.5, 0.45, 0)), 0);
    EXPECT_GT(north - south, 0.5);
    EXPECT_NEAR(north, -south, 0.02);
}

TEST(Errors, NameFileAndPlace) {
    const json far = json::array({height_curve(polyline({{0.2, 0.2, 0}, {0.5, 0.5, 3}}), 1, 1)});
    const std::string message = error_of(flat(), far);
    EXPECT_NE(message.find("test.pvg.json: /layers/0/primitives/0/path/points/1"), std::string::npos) << message;
    EXPECT_NE(message.find("5 %"), std::string::npos) << message;
    json any = far;
    any[0]["path"]["snap"] = "any";
    EXPECT_EQ(error_of(flat(), any), "");

    // A circle that meets the border: the largest radius is named.
    const std::string circle_message = error_of(flat(), json::array({height_curve(circle(0.3, 0.5, 0.4), 1, 1)}));
    EXPECT_NE(circle_message.find("test.pvg.json: /layers/0/primitives/0"), std::string::npos) << circle_message;

    const std::string missing =
        error_of(flat(), json::array({height_curve(polyline({{{"face", 99999}, {"bary", {1, 0, 0}}}, {0.5, 0.5, 0}}), 1, 1)}));
    EXPECT_NE(missing.find("99999"), std::string::npos) << missing;
}

TEST(Errors, ARegionMustBoundSomething) {
    const Surface torus = fixtures::torus(24, 48);
    // Around the tube: a closed curve that does not separate.
    json around = json::array();
    for (int i = 0; i < 6; ++i) {
        const double angle = 2 * std::numbers::pi * i / 6;
        around.push_back({1 + 0.4 * std::cos(angle), 0, 0.4 * std::sin(angle)});
    }
    const std::string separates = error_of(torus, json::array({region(polyline(around, true), {{"rise", {{"height", 1}}}})}));
    EXPECT_NE(separates.find("does not separate"), std::string::npos) << separates;
    EXPECT_NE(separates.find("/layers/0/primitives/0"), std::string::npos) << separates;

    const json eight = polyline({{0.2, 0.2, 0}, {0.8, 0.8, 0}, {0.8, 0.2, 0}, {0.2, 0.8, 0}}, true);
    const std::string crosses = error_of(flat(), json::array({ground, region(eight, {{"rise", {{"height", 1}}}})}));
    EXPECT_NE(crosses.find("meets itself"), std::string::npos) << crosses;

    // Two sheets that were cut apart along x = 1/2 stand for an edge with three faces.
    const std::string manifold =
        error_of(flat(),
                 json::array({ground, region(polyline({{0, 0.3, 0}, {0.4, 0.3, 0}, {0.4, 0.6, 0}, {0, 0.6, 0}}, true),
                                             {{"rise", {{"height", 1}}}})}),
                 [](BaseSurface& base) {
                     base.non_manifold_edges.push_back({Point(0, 0.2, 0), Point(0, 0.7, 0)});
                 });
    EXPECT_NE(manifold.find("more than two faces"), std::string::npos) << manifold;

    const std::string unreached = error_of(flat(), json::array({region(circle(0.5, 0.5, 0.2), {{"rise", {{"height", 1}}}})}));
    EXPECT_NE(unreached.find("needs at least one diffusion curve"), std::string::npos) << unreached;
}

TEST(Arrangement, DisabledPrimitivesAreSkipped) {
    json off = region(circle(0.5, 0.5, 0.2), {{"rise", {{"height", 1}}}, {"enabled", false}});
    const Arranged a = arranged(flat(), json::array({off, ground}));
    EXPECT_TRUE(a.result.domains.at(0).sources.empty());
    EXPECT_EQ(a.result.imprinted.surface.vertex_count(), flat().vertex_count());
}

TEST(Arrangement, FacePointsFollowTheSubdivision) {
    // A point given on a face of the file lands at the same place after the faces were split.
    const Surface coarse = fixtures::plane(4, 4);
    const Face& face = coarse.face(9);
    const Point expected = 0.2 * coarse.point(face[0]) + 0.3 * coarse.point(face[1]) + 0.5 * coarse.point(face[2]);
    const Scene scene =
        scene_of(json::array({height_curve(polyline({{{"face", 9}, {"bary", {0.2, 0.3, 0.5}}}, {0.9, 0.9, 0}}), 1, 1)}));
    BaseSurface base = base_of(coarse);
    std::vector<Point> points = coarse.points();
    std::vector<Face> faces;
    base.map.face.clear();
    for (int f = 0; f < coarse.face_count(); ++f) {
        const auto& [a, b, c] = coarse.face(f);
        const int middle = static_cast<int>(points.size());
        points.push_back((coarse.point(a) + coarse.point(b) + coarse.point(c)) / 3);
        base.map.vertex.push_back({{a, b, c}, {1.0 / 3, 1.0 / 3, 1.0 / 3}});
        for (const Face& part : {Face{a, b, middle}, Face{b, c, middle}, Face{c, a, middle}}) {
            faces.push_back(part);
            base.map.face.push_back(f);
        }
    }
    base.surface = Surface(std::move(points), std::move(faces));
    Warnings warnings;
    const Arrangement a = arrange(scene, base, warnings);
    double nearest = 1;
    const Domain& d = a.domains.at(0);
    for (int v = 0; v < d.surface.vertex_count(); ++v)
        if (d.dirichlet[v])
            nearest = std::min(nearest, (d.surface.point(v) - expected).norm());
    EXPECT_LT(nearest, 1e-12);
}

/// How many vertices have a value that is none of the given ones, constants on both sides of curves that meet.
int leaked(const Surface& surface, const json& primitives, const std::vector<double>& values) {
    const Arranged a = arranged(surface, primitives);
    const Eigen::MatrixXd u = solve_plainly(a.result.domains.at(0));
    int count = 0;
    for (int v = 0; v < u.rows(); ++v)
        count += std::none_of(values.begin(), values.end(),
                              [&](double value) { return std::abs(u(v, 0) - value) < 1e-9; });  // constants: rounding only
    return count;
}

// The frame moves in steps that are no multiple of an edge (1/60), so that its sides snap to vertices in most positions.
constexpr int positions = 12;
json frame(int i) {
    const double low = 0.21 + 0.0013 * i, high = 0.77 + 0.0017 * i;
    return height_curve(polyline({{low, low, 0}, {high, low, 0}, {high, high, 0}, {low, high, 0}}, true), nullptr, 5);
}
json bar(int i, double shorter = 0) {
    const double low = 0.21 + 0.0013 * i + shorter, high = 0.77 + 0.0017 * i - shorter, y = 0.4 + 0.003 * i;
    return height_curve(polyline({{low, y, 0}, {high, y + 0.01, 0}}), 1, 2);
}

TEST(Joints, ACurveThatEndsOnAnotherIsSlitToItsEnd) {
    const double edge = 1.0 / 60;
    for (const Surface& surface : {flat(), fixtures::plane(60, 60)})
        for (const double shorter : {0.0, 0.05 * edge, -0.05 * edge})  // drawn on the frame, short of it, past it
            for (int i = 0; i < positions; ++i) {
                EXPECT_EQ(leaked(surface, json::array({frame(i), bar(i, shorter)}), {1, 2, 5}), 0)
                    << i << ", frame first, " << shorter;
                EXPECT_EQ(leaked(surface, json::array({bar(i, shorter), frame(i)}), {1, 2, 5}), 0)
                    << i << ", bar first, " << shorter;
            }
}

TEST(Joints, CurvesThatEndInOnePointMeetThere) {
    // A square of four open curves, corners drawn exactly or up to 0.05 edges apart.
    fixtures::Random random(3);
    for (const double gap : {0.0, 0.035 / 60})
        for (int i = 0; i < positions; ++i) {
            const double low = 0.21 + 0.0013 * i, high = 0.77 + 0.0017 * i;
            const std::array<std::array<double, 2>, 4> corner{{{low, low}, {high, low}, {high, high}, {low, high}}};
            const auto at = [&](int k) {
                return json{corner[k][0] + random.real(-gap, gap), corner[k][1] + random.real(-gap, gap), 0};
            };
            json sides = json::array();
            for (int k = 0; k < 4; ++k) sides.push_back(height_curve(polyline({at(k), at((k + 1) % 4)}), 1, 2));
            EXPECT_EQ(leaked(flat(), sides, {1, 2}), 0) << i << ", " << gap;
        }
}

TEST(Joints, AnOpenCurveThatNearlyClosesIsClosed) {
    for (const double gap : {0.0, 0.05 / 60})
        for (int i = 0; i < positions; ++i) {
            const double low = 0.21 + 0.0013 * i, high = 0.77 + 0.0017 * i;
            const json path = polyline({{low, low, 0}, {high, low, 0}, {high, high, 0}, {low, high, 0}, {low, low + gap, 0}});
            EXPECT_EQ(leaked(flat(), json::array({height_curve(path, 1, 2)}), {1, 2}), 0) << i << ", " << gap;
        }
}

TEST(Joints, ACurveThatEndsOnItselfIsSlitToItsEnd) {
    // A "9": its loop is closed by its own stem; run backwards, at its first point.
    for (const double away : {0.0, 0.05 / 60, -0.05 / 60})
        for (int i = 0; i < positions; ++i) {
            const double low = 0.31 + 0.0013 * i, high = 0.77 + 0.0017 * i, y = 0.5 + 0.003 * i;
            json points = {{high, 0.2, 0}, {high, high, 0}, {low, high, 0}, {low, y, 0}, {high - away, y + 0.01, 0}};
            for (const bool backwards : {false, true}) {
                if (backwards)
                    std::reverse(points.begin(), points.end());
                const json nine = backwards ? height_curve(polyline(points), 2, 1) : height_curve(polyline(points), 1, 2);
                const Arranged a = arranged(flat(), json::array({nine}));
                const Domain& d = a.result.domains.at(0);
                // The loop is cut off: two components.
                int count = 0;
                face_components(d.surface, &count);
                EXPECT_EQ(count, 2) << i << ", " << away << ", " << backwards;
            }
        }
}

TEST(Joints, ACurveThatEndsAtTheBorderDividesTheSurface) {
    for (const double away : {0.0, 0.05 / 60})
        for (int i = 0; i < positions; ++i) {
            const json across = height_curve(polyline({{away, 0.4 + 0.003 * i, 0}, {1 - away, 0.5, 0}}), 1, 2);
            EXPECT_EQ(leaked(flat(), json::array({across}), {1, 2}), 0) << i << ", " << away;
        }
}

TEST(Joints, EndsThatAreFartherStayWhereTheyAre) {
    const double edge = 1.0 / 60;
    for (const bool frame_first : {true, false}) {
        json primitives = json::array({frame(0), bar(0, 0.4 * edge)});
        if (!frame_first)
            std::swap(primitives[0], primitives[1]);
        const Arranged a = arranged(fixtures::plane(60, 60), primitives);
        const Domain& d = a.result.domains.at(0);
        double left = 1, right = 0;
        for (int v = 0; v < d.surface.vertex_count(); ++v)
            if (d.dirichlet[v] && d.dirichlet_value(v, 0) < 4) {
                left = std::min(left, d.surface.point(v)[0]);
                right = std::max(right, d.surface.point(v)[0]);
            }
        // Imprinting snaps by 0.05 x the shortest edge.
        EXPECT_NEAR(left, 0.21 + 0.4 * edge, 0.051 * edge);
        EXPECT_NEAR(right, 0.77 - 0.4 * edge, 0.051 * edge);
        EXPECT_GT(leaked(fixtures::plane(60, 60), primitives, {1, 2, 5}), 0);
    }
}

TEST(Joints, AreTheSameOnACurvedSurface) {
    // The equator of a sphere and three curves from near its pole that end on it, each drawn on one side of the next.
    for (int i = 0; i < positions; ++i) {
        const Surface sphere = fixtures::rotated(fixtures::icosphere(16), 0.3 * i);
        const auto on = [](double latitude, double longitude) {
            return json{std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude), std::sin(latitude)};
        };
        json equator = json::array();
        for (int k = 0; k < 4; ++k) equator.push_back(on(0, k * std::numbers::pi / 2));
        json primitives = json::array({height_curve(polyline(equator, true), nullptr, 5)});
        // The sector between two meridians has the first one's left and the second one's right.
        for (int k = 0; k < 3; ++k)
            primitives.push_back(height_curve(polyline({on(1.5, 0.3), on(0, 0.5 + 2.1 * k)}), 1 + (k + 1) % 3, 1 + k));
        EXPECT_EQ(leaked(sphere, primitives, {1, 2, 3, 5}), 0) << i;
    }
}

}  // namespace
}  // namespace pvg::test
