// Paths, level sets and circles read from exact fields.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "fixtures/meshes.h"
#include "geodesic/checks.h"
#include "geodesic/paths.h"
#include "pvg/status.h"

namespace pvg {
namespace {

using namespace fixtures;
using checks::broken_pieces;
using checks::field_of;
using checks::path_length;
constexpr double pi = std::numbers::pi;
constexpr double exact = 1e-12;  // unfolding rounds once a face

Surface bumpy() {
    return lifted(irregular_plane(20, 20), [](double x, double y) { return 0.1 * std::sin(20 * x) * std::cos(17 * y); });
}

/// Sum of signed areas under a closed path in the plane: positive when counter-clockwise.
double signed_area(const Surface& surface, const SurfacePath& path) {
    double sum = 0;
    for (std::size_t i = 0; i < path.points.size(); ++i) {
        const Point a = surface.position(path.points[i]), b = surface.position(path.points[(i + 1) % path.points.size()]);
        sum += (a.x() * b.y() - a.y() * b.x()) / 2;
    }
    return sum;
}

TEST(GeodesicPaths, AreAsLongAsTheDistance) {
    for (const Surface& surface : {plane(12, 9), slit_plane(4), l_shape(6), icosphere(6), torus(24, 10), cuboid(1, 2, 3),
                                   cylinder(12, 5), cone(9, 5), bumpy()}) {
        Random random(8);
        for (int round = 0; round < 6; ++round) {
            std::vector<GeodesicSource> sources{{{random.below(surface.face_count()), {0.2, 0.3, 0.5}}, 0}};
            if (round % 3 == 1)
                sources[0].at.bary = {0.3, 0.7, 0};
            if (round % 3 == 2)
                sources[0].at = at_vertex(surface, random.below(surface.vertex_count()));
            const GeodesicField field = field_of(surface, sources);
            for (int i = 0; i < 30; ++i) {
                SurfacePoint at{random.below(surface.face_count()), {0.1, 0.6, 0.3}};
                if (i % 3 == 1)
                    at.bary = {0, 0.25, 0.75};
                if (i % 3 == 2)
                    at.bary = {0, 1, 0};
                const SurfacePath path = path_to_source(surface, field, sources, at);
                const double d = distance_at(surface, field, sources, at);
                EXPECT_NEAR(path_length(surface, path), d, exact * d);
                EXPECT_EQ(broken_pieces(surface, path), 0);
                EXPECT_EQ(surface.position(path.points.front()), surface.position(at));
                EXPECT_NEAR((surface.position(path.points.back()) - surface.position(sources[0].at)).norm(), 0, exact);
                if (i >= 5)
                    continue;
                const SurfacePath there = shortest_path(surface, sources[0].at, at),
                                  back = shortest_path(surface, at, sources[0].at);
                EXPECT_NEAR(path_length(surface, there), d, exact * d);
                EXPECT_NEAR(path_length(surface, back), d, exact * d);
                EXPECT_EQ(surface.position(there.points.front()), surface.position(sources[0].at));
            }
        }
    }
}

TEST(GeodesicPaths, AcrossACube) {
    const Surface cube = cuboid();
    const SurfacePath path = shortest_path(cube, at_vertex(cube, 0), at_vertex(cube, 7));
    EXPECT_NEAR(path_length(cube, path), std::sqrt(5.0), exact);
    EXPECT_GE(path.points.size(), 3u);
    // Within one face it is the straight segment.
    const SurfacePath near = shortest_path(cube, {0, {0.6, 0.2, 0.2}}, {0, {0.2, 0.2, 0.6}});
    EXPECT_EQ(near.points.size(), 2u);
}

TEST(GeodesicPaths, FromAPointToItself) {
    const Surface cube = cuboid();
    EXPECT_EQ(path_length(cube, shortest_path(cube, at_vertex(cube, 3), at_vertex(cube, 3))), 0);
    EXPECT_EQ(path_length(cube, shortest_path(cube, {2, {0.2, 0.3, 0.5}}, {2, {0.2, 0.3, 0.5}})), 0);
}

TEST(GeodesicPaths, QueriesNeedWindows) {
    const Surface cube = cuboid();
    const std::vector<GeodesicSource> sources{{at_vertex(cube, 0), 0}};
    const GeodesicField field = geodesic_distances(cube, sources);
    EXPECT_THROW(distance_at(cube, field, sources, {5, {0.2, 0.3, 0.5}}), Error);
}

struct Measured {
    int loops = 0, closed = 0;
    double length = 0;
};

/// Checks what holds for every level set: right distance at every point, pieces within faces.
Measured measure(const Surface& surface, const std::vector<GeodesicSource>& sources, double distance) {
    const GeodesicField field = field_of(surface, sources);
    Measured measured;
    for (const SurfacePath& path : level_set(surface, field, sources, distance, 1e-5 * distance)) {
        ++measured.loops;
        measured.closed += path.closed;
        measured.length += path_length(surface, path);
        EXPECT_EQ(broken_pieces(surface, path), 0);
        for (std::size_t i = 0; i < path.points.size(); i += 7)
            EXPECT_NEAR(distance_at(surface, field, sources, path.points[i]), distance, 1e-11 * distance);
    }
    return measured;
}

// A chord off by e = 1e-5 r at its middle is shorter than its arc by the factor 1 - 4 e / (3 r).
constexpr double chords = 2e-5;

TEST(LevelSets, InThePlaneAreCircles) {
    const Surface regular = plane(20, 20), irregular = irregular_plane(30, 30);
    for (double r : {0.01, 0.1, 0.25, 0.3, 0.33, 0.45}) {  // on the regular grid most of these meet vertices and touch edges
        const Measured a = measure(regular, {{at_vertex(regular, 220), 0}}, r);
        EXPECT_EQ(a.loops, 1) << r;
        EXPECT_EQ(a.closed, 1) << r;
        EXPECT_NEAR(a.length, 2 * pi * r, chords * 2 * pi * r);
        const SurfacePoint inner = locate_flat(irregular, 0.503, 0.497);
        const Measured b = measure(irregular, {{inner, 0}}, r);
        EXPECT_EQ(b.loops, 1) << r;
        EXPECT_EQ(b.closed, 1) << r;
        EXPECT_NEAR(b.length, 2 * pi * r, chords * 2 * pi * r);
    }
}

TEST(LevelSets, EndAtTheBorder) {
    const Surface surface = irregular_plane(15, 15);
    const Measured corner = measure(surface, {{at_vertex(surface, 0), 0}}, 0.4);
    EXPECT_EQ(corner.loops, 1);
    EXPECT_EQ(corner.closed, 0);
    EXPECT_NEAR(corner.length, 0.4 * pi / 2, chords);
    const Measured side = measure(surface, {{locate_flat(surface, 0.5, 0.1), 0}}, 0.2);
    EXPECT_EQ(side.loops, 1);
    EXPECT_EQ(side.closed, 0);
    EXPECT_NEAR(side.length, 0.2 * 2 * (pi - std::acos(0.5)), chords);
}

TEST(LevelSets, OfTwoSourcesMeet) {
    const Surface surface = irregular_plane(21, 21);
    const std::vector<GeodesicSource> sources{{locate_flat(surface, 0.35, 0.5), 0}, {locate_flat(surface, 0.65, 0.5), 0.05}};
    const Measured apart = measure(surface, sources, 0.12);
    EXPECT_EQ(apart.loops, 2);
    EXPECT_NEAR(apart.length, 2 * pi * (0.12 + 0.07), chords * 2);
    const Measured joined = measure(surface, sources, 0.25);  // circles with radii 0.25 and 0.2 whose centers are 0.3 apart
    const double a = std::acos((0.09 + 0.0625 - 0.04) / (2 * 0.3 * 0.25)),
                 b = std::acos((0.09 + 0.04 - 0.0625) / (2 * 0.3 * 0.2));
    EXPECT_EQ(joined.loops, 1);
    EXPECT_EQ(joined.closed, 1);
    EXPECT_NEAR(joined.length, 2 * (pi - a) * 0.25 + 2 * (pi - b) * 0.2, chords * 2);
}

TEST(LevelSets, OnACubeOfTwelveTriangles) {
    const Surface cube = cuboid();
    for (double r : {0.05, 0.1}) {  // within a face, over an edge, over a corner with three right angles
        EXPECT_NEAR(measure(cube, {{{0, {0.3, 0.3, 0.4}}, 0}}, r).length, 2 * pi * r, chords);
        EXPECT_NEAR(measure(cube, {{{0, {0.5, 0.5, 0}}, 0}}, r).length, 2 * pi * r, chords);
        EXPECT_NEAR(measure(cube, {{at_vertex(cube, 0), 0}}, r).length, 1.5 * pi * r, chords);
    }
    for (double r : {0.5, 0.9, 1.0, 1.4, 1.7}) {
        const Measured large = measure(cube, {{{0, {0.3, 0.3, 0.4}}, 0}}, r);
        EXPECT_EQ(large.loops, 1);
        EXPECT_EQ(large.closed, 1);
        const Measured corner = measure(cube, {{at_vertex(cube, 0), 0}}, r);  // r = 1 meets three vertices
        EXPECT_EQ(corner.closed, corner.loops);
    }
}

TEST(LevelSets, OnASphereAndATorus) {
    const Surface sphere = icosphere(16);
    for (double r : {0.5, 1.0, 2.0, 3.0}) {
        const Measured loop = measure(sphere, {{at_vertex(sphere, 5), 0}}, r);
        EXPECT_EQ(loop.loops, 1);
        EXPECT_EQ(loop.closed, 1);
        EXPECT_NEAR(loop.length, 2 * pi * std::sin(r), 0.03);  // faceted: distances differ by 0.2 %
    }
    const Surface ring = torus(48, 20, 1, 0.4);
    EXPECT_EQ(measure(ring, {{at_vertex(ring, 3), 0}}, 1.0).loops, 1);
    EXPECT_EQ(measure(ring, {{at_vertex(ring, 3), 0}}, 1.6).loops, 2);  // has met itself around the tube (2 pi 0.4 / 2 = 1.26)
}

TEST(LevelSets, AroundTheTipsOfASlit) {
    const Surface surface = slit_plane(6);
    const int from = nearest_vertex(surface, Point(0.5, 0.25, 0));
    const double r = 0.5, to_tip = std::sqrt(0.125), behind = r - to_tip;
    const Measured arcs = measure(surface, {{at_vertex(surface, from), 0}}, r);
    // The circle itself to where it leaves the square, its part in the shadow of the slit left out, and an arc around each tip
    // from the slit's far side to the shadow's edge (an eighth of a turn from there).
    const double cut = std::acos(0.25 / r);  // half of what lies below y = 0; at x = 0 and x = 1 the circle just touches
    EXPECT_NEAR(arcs.length, r * (2 * pi - 2 * cut - pi / 2) + 2 * behind * 3 * pi / 4, chords);
    EXPECT_EQ(arcs.closed, 0);
}

SurfacePath circle(const Surface& surface, const SurfacePoint& center, double radius, const SurfacePoint& start) {
    return geodesic_circle(surface, center, radius, start, 1e-5 * radius);
}

std::string refusal(const Surface& surface, const SurfacePoint& center, double radius, const SurfacePoint& start) {
    try {
        circle(surface, center, radius, start);
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::bad_input);
        return error.what();
    }
    return {};
}

TEST(GeodesicCircles, InThePlane) {
    const Surface surface = irregular_plane(20, 20);
    const SurfacePoint at_face = locate_flat(surface, 0.48, 0.51), vertex = at_vertex(surface, 10 * 21 + 10),
                       on_edge{300, {0.4, 0.6, 0}};
    for (const SurfacePoint& center : {at_face, vertex, on_edge})
        for (const Point& towards : {Point(0.9, 0.9, 0), Point(0.1, 0.83, 0), Point(0.72, 0.03, 0), Point(0.5, 0.505, 0)}) {
            const SurfacePoint start = locate_flat(surface, towards.x(), towards.y());
            const Point c = surface.position(center);
            const double r = 0.8 * std::min({c.x(), c.y(), 1 - c.x(), 1 - c.y()});
            const SurfacePath path = circle(surface, center, r, start);
            EXPECT_TRUE(path.closed);
            EXPECT_EQ(broken_pieces(surface, path), 0);
            EXPECT_NEAR(signed_area(surface, path), pi * r * r, 1e-4 * r * r);
            const Point first = surface.position(path.points.front()) - c, aim = surface.position(start) - c;
            EXPECT_NEAR((first.normalized() - aim.normalized()).norm(), 0, 1e-9);
            for (const SurfacePoint& p : path.points) EXPECT_NEAR((surface.position(p) - c).norm(), r, exact);
        }
}

TEST(GeodesicCircles, InsideOneFaceAndAroundAVertexOfACube) {
    const Surface cube = cuboid();
    const SurfacePath small = circle(cube, {0, {0.3, 0.3, 0.4}}, 0.05, {0, {0.9, 0.05, 0.05}});
    const Point center = cube.position({0, {0.3, 0.3, 0.4}}), aim = cube.position({0, {0.9, 0.05, 0.05}}) - center;
    EXPECT_TRUE(small.closed);
    EXPECT_NEAR(((cube.position(small.points[0]) - center).normalized() - aim.normalized()).norm(), 0, 1e-9);
    EXPECT_NEAR(path_length(cube, small), 0.1 * pi, chords);
    EXPECT_NEAR(path_length(cube, circle(cube, at_vertex(cube, 0), 0.5, at_vertex(cube, 7))), 0.75 * pi, chords);
}

TEST(GeodesicCircles, ThatAreNotOneLoopAreErrorsWithTheLargestRadius) {
    const Surface square = plane(10, 10), ring = torus(48, 20, 1, 0.4), sphere = icosphere(10);
    EXPECT_NE(refusal(square, at_vertex(square, 60), 0.7, at_vertex(square, 0)).find("0.500"),
              std::string::npos);                                                                              // meets the border
    EXPECT_NE(refusal(ring, at_vertex(ring, 0), 2, at_vertex(ring, 5)).find("about 1.2"), std::string::npos);  // meets itself
    EXPECT_NE(refusal(sphere, at_vertex(sphere, 0), 4, at_vertex(sphere, 5)).find("about 3.1"),
              std::string::npos);  // shrinks to a point
    const Surface holed = grid_of_cells(20, 20, 1, 1, true, [](int x, int y) { return x != 12 || y != 12; });
    const int center = nearest_vertex(holed, Point(0.5, 0.5, 0));  // the hole's nearest corner is (0.6, 0.6)
    EXPECT_NE(refusal(holed, at_vertex(holed, center), 0.3, at_vertex(holed, 0)).find("0.1414"),
              std::string::npos);  // a hole inside
    EXPECT_FALSE(refusal(square, at_vertex(square, 60), -1, at_vertex(square, 0)).empty());
    EXPECT_FALSE(refusal(square, at_vertex(square, 60), 0.1, at_vertex(square, 60)).empty());
}

}  // namespace
}  // namespace pvg
