#include "solve/knots.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "fixtures/domains.h"
#include "geodesic/geodesic.h"
#include "pvg/status.h"
#include "solve/voronoi.h"

namespace pvg {
namespace {

using fixtures::plain_domain;

std::vector<double> distance_to(const Surface& surface, const std::vector<char>& marked) {
    std::vector<GeodesicSource> sources;
    for (int v = 0; v < surface.vertex_count(); ++v)
        if (marked[v])
            sources.push_back({at_vertex(surface, v), 0});
    return geodesic_distances(surface, sources).distance;
}

struct Sampled {
    Domain domain;
    KnotOptions options;
    Knots knots;
    std::vector<double> wanted;  // the sizing field, from exact distances
    std::vector<double> curve;
};

Sampled sampled_square() {
    Sampled s{fixtures::slit_square(4000).domain, {}, {}, {}, {}};
    s.options.spacing = 0.06;
    s.knots = place_knots(s.domain, s.options);
    s.curve = distance_to(s.domain.surface, s.domain.on_curve);
    const std::vector<double> feature = distance_to(s.domain.surface, s.domain.feature);
    for (std::size_t v = 0; v < s.curve.size(); ++v)
        s.wanted.push_back(std::clamp(std::min(s.options.grading * s.curve[v], s.options.feature_grading * feature[v]),
                                      0.01 * s.domain.edge_length[v], s.options.spacing));
    return s;
}

TEST(Knots, CurvesAndBordersAreKnots) {
    const Sampled s = sampled_square();
    for (int v = 0; v < s.domain.surface.vertex_count(); ++v)
        if (s.domain.on_curve[v] || s.domain.surface.is_border_vertex(v)) {
            EXPECT_NE(s.knots.knot_of_vertex[v], none) << v;
        }
    EXPECT_TRUE(std::is_sorted(s.knots.vertex.begin(), s.knots.vertex.end()));
    for (std::size_t k = 0; k < s.knots.vertex.size(); ++k)
        EXPECT_EQ(s.knots.knot_of_vertex[s.knots.vertex[k]], static_cast<int>(k));
}

TEST(Knots, NoVertexIsFartherThanItsSizeFromAKnot) {
    const Sampled s = sampled_square();
    std::vector<char> marked(s.domain.surface.vertex_count(), 0);
    for (int v : s.knots.vertex) marked[v] = 1;
    const std::vector<double> distance = distance_to(s.domain.surface, marked);
    // The sizing field sees distances along edges: within a few edges of a curve up to 8 % longer than exact ones.
    for (std::size_t v = 0; v < distance.size(); ++v) EXPECT_LE(distance[v], 1.08 * s.wanted[v]) << v;
}

TEST(Knots, FilledKnotsKeepTheirDistance) {
    const Sampled s = sampled_square();
    for (int v : s.knots.vertex) {
        if (s.domain.on_curve[v] || s.domain.surface.is_border_vertex(v))
            continue;
        double nearest = 1;
        for (int w : s.knots.vertex)
            if (w != v)
                nearest = std::min(nearest, (s.domain.surface.point(v) - s.domain.surface.point(w)).norm());
        // The size at the later one of two decides: farther from the curves, but perhaps nearer to a feature, by their distance.
        // Distances along edges are longer than exact ones.
        EXPECT_GE(nearest, 0.96 * (1 - s.options.feature_grading) * s.wanted[v]) << v;
    }
}

TEST(Knots, DensityIsAboutOnePerSquaredSize) {
    Domain domain = plain_domain(fixtures::irregular_plane(80, 80));
    KnotOptions options;
    options.spacing = 0.05;
    const Knots knots = place_knots(domain, options);
    int inside = 0;
    for (int v : knots.vertex) inside += !domain.surface.is_border_vertex(v);
    // Hexagonal packing has 1.15, random maximal packing about 0.7.
    EXPECT_GT(inside * options.spacing * options.spacing, 0.75);
    EXPECT_LT(inside * options.spacing * options.spacing, 1.15);
}

TEST(Knots, GradeTowardsFeatures) {
    Domain domain = plain_domain(fixtures::irregular_plane(60, 60));
    const int middle = fixtures::nearest_vertex(domain.surface, Point(0.5, 0.5, 0));
    KnotOptions options;
    options.spacing = 0.1;
    const auto count_near = [&] {
        int count = 0;
        for (int v : place_knots(domain, options).vertex)
            count += (domain.surface.point(v) - domain.surface.point(middle)).norm() < 0.2;
        return count;
    };
    const int before = count_near();
    domain.feature[middle] = 1;
    EXPECT_GT(count_near(), 3 * before);
}

TEST(Knots, VerticesWithinAnEdgeOfACurveAreKnots) {
    Domain domain = plain_domain(fixtures::irregular_plane(60, 60));
    KnotOptions options;
    options.spacing = 0.1;
    for (int v = 0; v < domain.surface.vertex_count(); ++v) domain.on_curve[v] = domain.surface.is_border_vertex(v);
    const std::vector<double> curve = distance_to(domain.surface, domain.on_curve);
    const Knots knots = place_knots(domain, options);
    int near = 0, far = 0, far_knots = 0;
    for (int v = 0; v < domain.surface.vertex_count(); ++v) {
        if (curve[v] < 1.0 / 60) {
            ++near;
            EXPECT_NE(knots.knot_of_vertex[v], none) << v;
        } else if (curve[v] > 0.2) {
            ++far;
            far_knots += knots.knot_of_vertex[v] != none;
        }
    }
    EXPECT_GT(near, 4 * 55);
    EXPECT_LT(4 * far_knots, far);
}

TEST(Knots, CellsStaySmallOnFineMeshes) {
    // However wide the spacing: at most five edges, about 20 vertices a cell, four times as many where knots are packed loosely.
    Domain domain = plain_domain(fixtures::irregular_plane(120, 120));
    KnotOptions options;
    options.spacing = 1;
    const Knots knots = place_knots(domain, options);
    int inside = 0;
    for (int v : knots.vertex) inside += !domain.surface.is_border_vertex(v);
    EXPECT_GT(40 * inside, domain.surface.vertex_count());
    EXPECT_LT(10 * inside, domain.surface.vertex_count());
    const Voronoi voronoi = geodesic_voronoi(domain, knots);
    std::vector<int> held(knots.vertex.size(), 0);
    for (int c : voronoi.cell) ++held[c];
    EXPECT_LE(*std::max_element(held.begin(), held.end()), 80);
}

TEST(Knots, GradeWhereTheSurfaceStretches) {
    // A bump of radius 0.1 in a plane: knots as dense as its curvature wants, elsewhere the spacing, the size growing in between.
    const Surface bump = fixtures::lifted(fixtures::irregular_plane(100, 100), [](double x, double y) {
        const double r2 = std::pow(x - 0.5, 2) + std::pow(y - 0.5, 2);
        return 0.15 * std::exp(-r2 / 0.01);
    });
    const auto counts = [](const Surface& surface, double curvature) {
        KnotOptions options;
        options.spacing = 0.1;
        options.most_edges = 100;
        options.curvature = curvature;
        std::array<int, 2> count{0, 0};
        for (int v : place_knots(plain_domain(surface), options).vertex) {
            const Point& p = surface.point(v);
            const double r = std::hypot(p.x() - 0.5, p.y() - 0.5);
            count[0] += r < 0.1;
            count[1] += r > 0.4 && !surface.is_border_vertex(v);
        }
        return count;
    };
    const auto with = counts(bump, 0.5), without = counts(bump, 1e9);
    EXPECT_GT(with[0], 4 * without[0]);
    EXPECT_LT(with[1], 1.2 * without[1]);
    // Bending without stretching costs nothing: a sheet rolled up (the border's vertices are knots anyway).
    const Surface sheet = fixtures::irregular_plane(60, 60);
    const Surface roll = fixtures::transformed(
        sheet, [](const Point& p) { return Point(0.1 * std::cos(10 * p.x()), 0.1 * std::sin(10 * p.x()), p.y()); });
    const auto flat = counts(sheet, 0.5);
    KnotOptions options;
    options.spacing = 0.1;
    const std::size_t on_sheet = place_knots(plain_domain(sheet), options).vertex.size();
    const std::size_t on_roll = place_knots(plain_domain(roll), options).vertex.size();
    EXPECT_NEAR(static_cast<double>(on_roll), static_cast<double>(on_sheet), 0.1 * static_cast<double>(on_sheet));
    EXPECT_EQ(flat, counts(sheet, 1e9));
    // The tip of a cone is a knot.
    const Surface cone = fixtures::lifted(sheet, [](double x, double y) { return std::hypot(x - 0.5, y - 0.5); });
    const int tip = fixtures::nearest_vertex(cone, Point(0.5, 0.5, 0));
    EXPECT_NE(place_knots(plain_domain(cone), options).knot_of_vertex[tip], none);
}

TEST(Knots, DoNotDependOnScale) {
    Domain domain = fixtures::slit_square(2000).domain;
    KnotOptions options;
    options.spacing = 0.07;
    const Knots first = place_knots(domain, options);
    domain.surface = fixtures::scaled(domain.surface, 4);  // a power of two: the same bits
    for (double& length : domain.edge_length) length *= 4;
    options.spacing *= 4;
    EXPECT_EQ(place_knots(domain, options).vertex, first.vertex);
}

TEST(Knots, EveryComponentGetsOne) {
    const Surface ball = fixtures::icosphere(4);
    std::vector<Point> points = ball.points();
    std::vector<Face> faces = ball.faces();
    for (const Point& p : ball.points()) points.push_back(p + Point(5, 0, 0));
    for (const Face& f : ball.faces())
        faces.push_back({f[0] + ball.vertex_count(), f[1] + ball.vertex_count(), f[2] + ball.vertex_count()});
    const Domain domain = plain_domain(Surface(points, faces));
    KnotOptions options;
    options.spacing = options.most_edges = 100;
    options.curvature = 1e9;  // the spheres' own is not the question here
    const Knots knots = place_knots(domain, options);
    ASSERT_EQ(knots.vertex.size(), 2u);
    EXPECT_LT(knots.vertex[0], ball.vertex_count());
    EXPECT_GE(knots.vertex[1], ball.vertex_count());
}

TEST(Knots, RefuseSpacingZero) { EXPECT_THROW(place_knots(plain_domain(fixtures::plane(4, 4)), {}), Error); }

}  // namespace
}  // namespace pvg
