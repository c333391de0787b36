// Laws of exact distances, and cases with the answer known by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fixtures/meshes.h"
#include "geodesic/checks.h"
#include "geodesic/geodesic.h"
#include "pvg/status.h"

namespace pvg {
namespace {

using namespace fixtures;
constexpr double pi = std::numbers::pi;
constexpr double infinity = std::numeric_limits<double>::infinity();

// Unfolding rounds once a face, and results are compared relatively.
constexpr double exact = 1e-12;

std::vector<Surface> zoo() {
    return {plane(12, 9),
            irregular_plane(20, 20),
            slit_plane(4),
            l_shape(6),
            icosphere(6),
            torus(24, 10),
            cuboid(1, 2, 3),
            cylinder(12, 5),
            lifted(irregular_plane(20, 20), [](double x, double y) { return 0.1 * std::sin(20 * x) * std::cos(17 * y); })};
}

std::vector<GeodesicSource> random_sources(const Surface& surface, int count, std::uint64_t seed) {
    Random random(seed);
    std::vector<GeodesicSource> sources;
    for (int i = 0; i < count; ++i) {
        SurfacePoint at{random.below(surface.face_count()), {0.5, 0.2, 0.3}};
        if (i % 3 == 0)
            at = at_vertex(surface, random.below(surface.vertex_count()));
        if (i % 3 == 1)
            at.bary = {0.25, 0, 0.75};
        sources.push_back({at, 0});
    }
    return sources;
}

void expect_euclid(const Surface& flat, const SurfacePoint& from) {
    const GeodesicSource source{from, 0};
    const GeodesicField field = geodesic_distances(flat, std::span(&source, 1));
    const Point p = flat.position(from);
    double turn = 0;  // direction in the plane minus direction on the surface: one constant
    bool first = true;
    for (int v = 0; v < flat.vertex_count(); ++v) {
        const Point d = flat.point(v) - p;
        if (d.norm() == 0)
            continue;
        ASSERT_NEAR(field.distance[v], d.norm(), exact * d.norm()) << "vertex " << v;
        const double off = std::atan2(d.y(), d.x()) - field.direction[v];
        if (first)
            turn = off;
        first = false;
        ASSERT_NEAR(std::remainder(off - turn, 2 * pi), 0, 1e-11) << "direction at vertex " << v;
    }
}

TEST(GeodesicDistances, PlaneIsEuclideanWithPolarLogMap) {
    const Surface regular = plane(30, 20, 3, 2), irregular = irregular_plane(40, 40);
    expect_euclid(regular, at_vertex(regular, 10 * 31 + 15));
    expect_euclid(irregular, at_vertex(irregular, 20 * 41 + 15));
    expect_euclid(irregular, {1234, {0.2, 0.3, 0.5}});
    expect_euclid(irregular, {1234, {0.4, 0.6, 0}});
    expect_euclid(irregular, {1234, {0, 0.4, 0.6}});
    expect_euclid(irregular, {1234, {0.4, 0, 0.6}});
}

TEST(GeodesicDistances, DirectionAtAVertexStartsAtItsOutgoingHalfedge) {
    const Surface surface = irregular_plane(10, 10);
    const int center = 5 * 11 + 5;
    const GeodesicSource source{at_vertex(surface, center), 0};
    const GeodesicField field = geodesic_distances(surface, std::span(&source, 1));
    const Point first = surface.point(surface.target(surface.outgoing(center))) - surface.point(center);
    for (int v = 0; v < surface.vertex_count(); ++v) {
        if (v == center)
            continue;
        const Point d = surface.point(v) - surface.point(center);
        const double angle = std::atan2(first.x() * d.y() - first.y() * d.x(), first.dot(d));
        EXPECT_NEAR(std::remainder(field.direction[v] - angle, 2 * pi), 0, 1e-12);
        EXPECT_GE(field.direction[v], 0);
        EXPECT_LT(field.direction[v], 2 * pi + 1e-12);
    }
}

TEST(GeodesicDistances, SliversInThePlaneChangeNothing) {
    // Triangles 3,000 times as long as high, and the sources' own faces among them. Angles in them are good to about 1e-13.
    const Surface slivers = transformed(irregular_plane(15, 15), [](const Point& p) { return Point(p.x(), p.y() / 3000, 0); });
    const GeodesicSource source{{111, {0.2, 0.3, 0.5}}, 0};
    const GeodesicField field = geodesic_distances(slivers, std::span(&source, 1));
    for (int v = 0; v < slivers.vertex_count(); ++v) {
        const double d = (slivers.point(v) - slivers.position(source.at)).norm();
        EXPECT_NEAR(field.distance[v], d, 1e-9 * d);
    }
}

TEST(GeodesicDistances, ZeroAtSourcesAndLipschitzAlongEdges) {
    for (const Surface& surface : zoo()) {
        const auto sources = random_sources(surface, 4, 3);
        const GeodesicField field = geodesic_distances(surface, sources);
        for (int i : {0, 3}) {
            int corner = 0;
            sources[i].at.bary.maxCoeff(&corner);
            EXPECT_EQ(field.distance[surface.face(sources[i].at.face)[corner]], 0);
            EXPECT_EQ(field.root[surface.face(sources[i].at.face)[corner]], i);
        }
        for (int h = 0; h < surface.halfedge_count(); ++h)
            ASSERT_LE(std::abs(field.distance[surface.origin(h)] - field.distance[surface.target(h)]),
                      surface.length(h) * (1 + exact));
    }
}

TEST(GeodesicDistances, ManySourcesAreTheLeastOfSingleOnes) {
    for (const Surface& surface : zoo()) {
        auto sources = random_sources(surface, 7, 5);
        sources[2].distance = 0.07;
        const GeodesicField together = geodesic_distances(surface, sources);
        std::vector<GeodesicField> single;
        for (const GeodesicSource& source : sources) single.push_back(geodesic_distances(surface, std::span(&source, 1)));
        for (int v = 0; v < surface.vertex_count(); ++v) {
            double least = infinity;
            for (const GeodesicField& field : single) least = std::min(least, field.distance[v]);
            ASSERT_NEAR(together.distance[v], least, exact * least) << "vertex " << v;
            const GeodesicField& own = single[together.root[v]];
            ASSERT_NEAR(own.distance[v], least, exact * least) << "root of vertex " << v;
        }
    }
}

TEST(GeodesicDistances, ScaleRotationAndNumberingChangeNothing) {
    for (const Surface& surface : zoo()) {
        const int from = surface.vertex_count() / 3;
        const auto distances = [](const Surface& s, int v) {
            const GeodesicSource source{at_vertex(s, v), 0};
            return geodesic_distances(s, std::span(&source, 1)).distance;
        };
        const std::vector<double> plain = distances(surface, from), turned = distances(rotated(surface, 0.7), from);
        const Permuted other = permuted(surface, 9);
        const std::vector<double> renumbered = distances(other.surface, other.vertex[from]);
        for (int v = 0; v < surface.vertex_count(); ++v) {
            EXPECT_NEAR(turned[v], plain[v], exact * plain[v]);
            EXPECT_NEAR(renumbered[other.vertex[v]], plain[v], exact * plain[v]);
        }
        for (double factor : {1e-6, 1e6}) {
            const std::vector<double> resized = distances(scaled(surface, factor), from);
            for (int v = 0; v < surface.vertex_count(); ++v)
                EXPECT_NEAR(resized[v], factor * plain[v], exact * factor * plain[v]);
        }
    }
}

TEST(GeodesicDistances, AroundAConeTheShorterSideCounts) {
    const int count = 14;
    const double total = 5, step = total / count;
    const Surface surface = cone(count, total);
    const GeodesicSource source{at_vertex(surface, 1), 0};
    const GeodesicField field = geodesic_distances(surface, std::span(&source, 1));
    EXPECT_FALSE(field.is_pseudo_source[0]);
    for (int i = 0; i < count; ++i) EXPECT_NEAR(field.distance[1 + i], 2 * std::sin(std::min(i, count - i) * step / 2), exact);
}

/// A fan of isosceles triangles with legs 1 around vertex 0, angles `total` > 2 pi together; an even count.
Surface saddle(int count, double total) {
    const double chord = 2 * std::sin(total / count / 2), s = std::pow(std::sin(pi / count), 2);
    const double h = std::sqrt((chord * chord / 4 - s) / (1 - s)), r = std::sqrt(1 - h * h);
    std::vector<Point> points{Point::Zero()};
    std::vector<Face> faces;
    for (int i = 0; i < count; ++i) {
        points.emplace_back(r * std::cos(2 * pi * i / count), r * std::sin(2 * pi * i / count), i % 2 ? h : -h);
        faces.push_back({0, i + 1, (i + 1) % count + 1});
    }
    return Surface(std::move(points), std::move(faces));
}

TEST(GeodesicDistances, PathsBendAtASaddle) {
    const int count = 16;
    const double total = 8, step = total / count;
    const Surface surface = saddle(count, total);
    const GeodesicSource source{at_vertex(surface, 1), 0};
    const GeodesicField field = geodesic_distances(surface, std::span(&source, 1));
    EXPECT_TRUE(field.is_pseudo_source[0]);
    for (int i = 0; i < count; ++i) {
        const double angle = std::min(i, count - i) * step;
        EXPECT_NEAR(field.distance[1 + i], angle < pi ? 2 * std::sin(angle / 2) : 2, exact) << "vertex " << i;
        // Behind the saddle all start towards it. outgoing(1) is the border edge to vertex 2; the spoke follows at the base
        // angle.
        if (angle > pi) {
            EXPECT_NEAR(field.direction[1 + i], (pi - step) / 2, exact);
            EXPECT_EQ(field.via[1 + i], 0);
        }
    }
}

TEST(GeodesicDistances, AroundAReflexCorner) {
    const Surface surface = l_shape(8);
    const Point corner(0.5, 0.5, 0);
    const int from = nearest_vertex(surface, {0.875, 0.3125, 0});
    const GeodesicSource source{at_vertex(surface, from), 0};
    const GeodesicField field = geodesic_distances(surface, std::span(&source, 1));
    EXPECT_TRUE(field.is_pseudo_source[nearest_vertex(surface, corner)]);
    for (int v = 0; v < surface.vertex_count(); ++v) {
        const Point a = surface.point(from), b = surface.point(v);
        const Point to_corner = corner - a, to_b = b - a;
        const bool hidden = b.y() > 0.5 && to_corner.x() * to_b.y() - to_corner.y() * to_b.x() < 0;
        const double d = hidden ? to_corner.norm() + (b - corner).norm() : to_b.norm();
        EXPECT_NEAR(field.distance[v], d, exact);
    }
}

TEST(GeodesicDistances, AroundTheTipsOfASlit) {
    const Surface surface = slit_plane(6);
    const Point left(0.25, 0.5, 0), right(0.75, 0.5, 0);
    const int from = nearest_vertex(surface, Point(0.5, 0.25, 0));
    const GeodesicSource source{at_vertex(surface, from), 0};
    const GeodesicField field = geodesic_distances(surface, std::span(&source, 1));
    EXPECT_TRUE(field.is_pseudo_source[nearest_vertex(surface, left)]);
    EXPECT_TRUE(field.is_pseudo_source[nearest_vertex(surface, right)]);
    const Point a = surface.point(from);
    int hidden_count = 0;
    for (int v = 0; v < surface.vertex_count(); ++v) {
        const Point b = surface.point(v);
        double d = (b - a).norm();
        if (b.y() > 0.5) {
            const double x =
                a.x() + (b.x() - a.x()) * (0.5 - a.y()) / (b.y() - a.y());  // where the straight line meets the slit's line
            if (x > 0.25 && x < 0.75) {
                d = std::min((left - a).norm() + (b - left).norm(), (right - a).norm() + (b - right).norm());
                ++hidden_count;
            }
        } else if (b.y() == 0.5 && b.x() > 0.25 && b.x() < 0.75) {
            continue;  // two copies in one place; the Lipschitz law covers them
        }
        EXPECT_NEAR(field.distance[v], d, exact);
    }
    EXPECT_GT(hidden_count, 50);
}

TEST(GeodesicDistances, StopAtTargetsAndAtTheGreatestDistance) {
    const Surface surface = irregular_plane(25, 25);
    const GeodesicSource source{at_vertex(surface, 13 * 26 + 13), 0};
    const GeodesicField full = geodesic_distances(surface, std::span(&source, 1));
    GeodesicOptions near;
    near.max_distance = 0.3;
    const GeodesicField cut = geodesic_distances(surface, std::span(&source, 1), near);
    int reached = 0;
    for (int v = 0; v < surface.vertex_count(); ++v) {
        EXPECT_EQ(cut.distance[v], full.distance[v] <= 0.3 ? full.distance[v] : infinity);
        EXPECT_EQ(cut.root[v] == none, full.distance[v] > 0.3);
        reached += cut.root[v] != none;
    }
    EXPECT_GT(reached, 100);
    GeodesicOptions aimed;
    aimed.targets = {at_vertex(surface, 40), at_vertex(surface, 555)};
    const GeodesicField some = geodesic_distances(surface, std::span(&source, 1), aimed);
    EXPECT_EQ(some.distance[40], full.distance[40]);
    EXPECT_EQ(some.distance[555], full.distance[555]);
}

TEST(GeodesicDistances, InsideFacesTheNearestOfManySources) {
    const Surface surface = irregular_plane(24, 24);
    const auto sources = random_sources(surface, 60, 21);
    const GeodesicField field = checks::field_of(surface, sources);
    ASSERT_EQ(field.window_first.back(), field.windows.size());
    Random random(4);
    for (int i = 0; i < 500; ++i) {
        SurfacePoint at{random.below(surface.face_count()), {random.real(), random.real(), random.real()}};
        at.bary /= at.bary.sum();
        double least = infinity;
        for (const GeodesicSource& source : sources)
            least = std::min(least, (surface.position(source.at) - surface.position(at)).norm());
        EXPECT_NEAR(distance_at(surface, field, sources, at), least, exact);
    }
}

TEST(GeodesicDistances, WindowsGiveTheLogMap) {
    const Surface surface = irregular_plane(16, 16);
    const int center = 8 * 17 + 8;
    const std::vector<GeodesicSource> sources{{at_vertex(surface, center), 0}};
    const GeodesicField field = checks::field_of(surface, sources);
    const Point first = surface.point(surface.target(surface.outgoing(center))) - surface.point(center);
    for (const GeodesicWindow& w : field.windows) {
        ASSERT_EQ(w.via, none);
        const Point a = surface.point(surface.origin(w.halfedge)),
                    along = (surface.point(surface.target(w.halfedge)) - a).normalized();
        const double x = (w.begin + w.end) / 2;
        const Point d = a + x * along - surface.point(center);
        const double direction = w.rotation + std::atan2(-w.source.y(), x - w.source.x());
        EXPECT_NEAR(std::remainder(direction - std::atan2(first.x() * d.y() - first.y() * d.x(), first.dot(d)), 2 * pi), 0,
                    1e-11);
        EXPECT_NEAR(std::hypot(x - w.source.x(), w.source.y()), d.norm(), exact);
    }
}

TEST(GeodesicDistances, TiesGoToTheLowerIndex) {
    const Surface surface = plane(8, 8);
    const std::vector<GeodesicSource> sources{{at_vertex(surface, 4 * 9 + 8), 0}, {at_vertex(surface, 4 * 9), 0}};
    const GeodesicField field = geodesic_distances(surface, sources);
    for (int y = 0; y <= 8; ++y) EXPECT_EQ(field.root[y * 9 + 4], 0);
    const std::vector<GeodesicSource> twice{{at_vertex(surface, 40), 0}, {at_vertex(surface, 40), 0}};
    for (int root : geodesic_distances(surface, twice).root) EXPECT_EQ(root, 0);
}

TEST(GeodesicDistances, OtherComponentsAreInfinitelyFar) {
    std::vector<Point> points = cuboid().points();
    std::vector<Face> faces = cuboid().faces();
    for (int v = 0; v < 8; ++v) points.push_back(points[v] + Point(5, 0, 0));
    for (int f = 0; f < 12; ++f) faces.push_back({faces[f][0] + 8, faces[f][1] + 8, faces[f][2] + 8});
    points.emplace_back(9, 9, 9);  // in no face
    const Surface surface(points, faces);
    const GeodesicSource source{at_vertex(surface, 0), 0};
    const GeodesicField field = geodesic_distances(surface, std::span(&source, 1));
    EXPECT_NEAR(field.distance[7], std::sqrt(5.0), exact);
    for (int v = 8; v < 17; ++v) {
        EXPECT_EQ(field.distance[v], infinity);
        EXPECT_EQ(field.root[v], none);
    }
    EXPECT_THROW(at_vertex(surface, 16), Error);
    EXPECT_THROW(shortest_path(surface, at_vertex(surface, 0), at_vertex(surface, 8)), Error);
}

TEST(GeodesicDistances, SourcesOffTheSurfaceAreErrors) {
    const Surface surface = cuboid();
    for (const SurfacePoint& at :
         {SurfacePoint{12, {1, 0, 0}}, SurfacePoint{}, SurfacePoint{0, {0.5, 0.6, -0.1}}, SurfacePoint{0, {0.5, 0.6, 0.1}}}) {
        const GeodesicSource source{at, 0};
        EXPECT_THROW(geodesic_distances(surface, std::span(&source, 1)), Error);
    }
}

TEST(GeodesicDistances, ThousandsOfSourcesCostLessThanOne) {
    const Surface surface = irregular_plane(120, 120);
    Random random(2);
    std::vector<GeodesicSource> sources;
    for (int i = 0; i < 1500; ++i) sources.push_back({at_vertex(surface, random.below(surface.vertex_count())), 0});
    double all = infinity, one = infinity;
    for (int run = 0; run < 3; ++run) {
        const double start = checks::cpu_seconds();
        geodesic_distances(surface, sources);
        const double middle = checks::cpu_seconds();
        geodesic_distances(surface, std::span(sources.data(), 1));
        all = std::min(all, middle - start);
        one = std::min(one, checks::cpu_seconds() - middle);
    }
    RecordProperty("cpu_seconds_1500_sources", std::to_string(all));
    std::printf("%d vertices: 1500 sources %.3f s, one source %.3f s CPU\n", surface.vertex_count(), all, one);
    EXPECT_LT(all, one);
}

}  // namespace
}  // namespace pvg
