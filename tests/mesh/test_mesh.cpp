// Laws of the surface, of welding, of subdivision and of the maps between surfaces.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "fixtures/meshes.h"
#include "mesh/subdivide.h"
#include "mesh/surface.h"
#include "mesh/surface_map.h"
#include "mesh/weld.h"
#include "pvg/status.h"

namespace pvg::test {
namespace {

/// What an Error(bad_input) says, or "" where none is thrown.
template <typename Work>
std::string refusal(Work&& work) {
    try {
        work();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::bad_input);
        return error.what();
    }
    return "";
}

std::string refusal_of(std::vector<Point> points, std::vector<Face> faces) {
    return refusal([&] { Surface(std::move(points), std::move(faces)); });
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

int border_edges(const Surface& surface) {
    int count = 0;
    for (int h = 0; h < surface.halfedge_count(); ++h) count += surface.twin(h) == none;
    return count;
}

int euler(const Surface& surface) {
    const int edges = (surface.halfedge_count() + border_edges(surface)) / 2;
    return surface.vertex_count() - edges + surface.face_count();
}

bool same_bits(const Point& a, const Point& b) { return std::memcmp(a.data(), b.data(), 3 * sizeof(double)) == 0; }

const std::vector<Point> square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 1}};

TEST(Surface, NamesWhatItRefuses) {
    EXPECT_EQ(refusal_of(square, {{0, 1, 2}, {0, 2, 3}}), "");
    EXPECT_TRUE(contains(refusal_of(square, {{0, 1, 2}, {0, 2, 5}}), "face 1: vertex 5"));
    EXPECT_TRUE(contains(refusal_of(square, {{0, -1, 2}}), "face 0: vertex -1"));
    EXPECT_TRUE(contains(refusal_of(square, {{0, 1, 2}, {2, 3, 2}}), "face 1 repeats"));
    EXPECT_TRUE(contains(refusal_of(square, {{0, 1, 2}, {0, 1, 3}}), "edge 0 - 1"));             // one of them is upside down
    EXPECT_TRUE(contains(refusal_of(square, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}), "edge 0 - 1"));  // three faces
    std::vector<Point> more = square;
    more.insert(more.end(), {{-1, 0, 0}, {-1, -1, 0}});
    EXPECT_TRUE(contains(refusal_of(more, {{0, 1, 2}, {0, 5, 6}}), "vertex 0"));  // a bow tie
}

TEST(Surface, FansRunCounterClockwiseFromTheBorder) {
    for (const Surface& surface : {fixtures::plane(5, 4), fixtures::icosphere(3), fixtures::cylinder(7, 3)}) {
        std::vector<int> visited(surface.halfedge_count(), 0);
        for (int v = 0; v < surface.vertex_count(); ++v) {
            const int start = surface.outgoing(v);
            ASSERT_NE(start, none);
            bool on_border = false;
            int h = start;
            do {
                EXPECT_EQ(surface.origin(h), v);
                ++visited[h];
                on_border = on_border || surface.twin(h) == none;
                const int next = surface.twin(Surface::prev(h));
                if (next != none) {
                    // Counter-clockwise: the next face begins where this one ends.
                    EXPECT_EQ(surface.target(next), surface.origin(Surface::prev(h)));
                } else {
                    EXPECT_EQ(surface.twin(start), none);
                }
                h = next;
            } while (h != none && h != start);
            EXPECT_EQ(surface.is_border_vertex(v), on_border);
        }
        for (int count : visited) EXPECT_EQ(count, 1);
        for (int h = 0; h < surface.halfedge_count(); ++h) {
            EXPECT_EQ(surface.halfedge_between(surface.origin(h), surface.target(h)), h);
            if (surface.twin(h) == none)
                continue;
            EXPECT_EQ(surface.twin(surface.twin(h)), h);
            EXPECT_EQ(surface.origin(surface.twin(h)), surface.target(h));
        }
    }
}

TEST(Surface, AVertexWithoutFacesIsAllowed) {
    const Surface surface(square, {{0, 1, 2}});
    EXPECT_EQ(surface.outgoing(4), none);
    EXPECT_FALSE(surface.is_border_vertex(4));
    EXPECT_EQ(surface.angle_sum(4), 0);
    EXPECT_DOUBLE_EQ(surface.diagonal(), std::sqrt(2.0));  // vertex 4, above the square, is not used
}

TEST(Surface, CurvatureSumsToTheEulerCharacteristic) {
    // Gauss and Bonnet: 2 pi - angles inside, pi - angles on the border, together 2 pi times the characteristic.
    const double pi = std::numbers::pi;
    const struct {
        Surface surface;
        int characteristic;
    } cases[] = {{fixtures::icosphere(8), 2},
                 {fixtures::torus(12, 20), 0},
                 {fixtures::plane(7, 5), 1},
                 {fixtures::cylinder(9, 4), 0},
                 {fixtures::cuboid(1, 2, 3), 2}};
    for (const auto& [surface, characteristic] : cases) {
        double sum = 0;
        for (int v = 0; v < surface.vertex_count(); ++v)
            sum += (surface.is_border_vertex(v) ? pi : 2 * pi) - surface.angle_sum(v);
        EXPECT_NEAR(sum, 2 * pi * characteristic, 1e-12 * surface.vertex_count());  // rounding of each angle
        EXPECT_EQ(euler(surface), characteristic);
    }
}

TEST(Surface, KnowsAreasAndNormalsOfACuboid) {
    const Surface surface = fixtures::cuboid(1, 2, 3);
    EXPECT_DOUBLE_EQ(surface.area(), 2 * (1 * 2 + 2 * 3 + 3 * 1));
    EXPECT_DOUBLE_EQ(surface.diagonal(), std::sqrt(14.0));
    const std::vector<Point> normals = vertex_normals(surface);
    for (int v = 0; v < 8; ++v) {
        // Three right angles at every corner weigh the same: the normal is the space diagonal's, outwards.
        const Point outwards = (surface.point(v) - Point(0.5, 1, 1.5)).cwiseSign() / std::sqrt(3.0);
        EXPECT_LT((normals[v] - outwards).norm(), 1e-15 * 8);
    }
    for (int f = 0; f < surface.face_count(); ++f) {
        const Face& face = surface.face(f);
        const Point middle = (surface.point(face[0]) + surface.point(face[1]) + surface.point(face[2])) / 3;
        EXPECT_GT(surface.face_normal(f).dot(middle - Point(0.5, 1, 1.5)), 0);
        for (int k = 0; k < 3; ++k)
            EXPECT_TRUE(same_bits(surface.position({f, Eigen::Vector3d::Unit(k)}), surface.point(face[k])));
    }
}

TEST(Surface, CountsItsParts) {
    const Surface one = fixtures::icosphere(2);
    std::vector<Point> points = one.points();
    std::vector<Face> faces = one.faces();
    for (const Point& p : one.points()) points.push_back(p + Point(5, 0, 0));
    for (const Face& face : one.faces())
        faces.push_back({face[0] + one.vertex_count(), face[1] + one.vertex_count(), face[2] + one.vertex_count()});
    int count = 0;
    const std::vector<int> part = face_components(Surface(points, faces), &count);
    EXPECT_EQ(count, 2);
    for (int f = 0; f < static_cast<int>(part.size()); ++f) EXPECT_EQ(part[f], f < one.face_count() ? 0 : 1);
}

struct Soup {
    std::vector<Point> points;
    std::vector<Face> faces;
};

/// Every face with three vertices of its own.
Soup torn(const Surface& surface) {
    Soup soup;
    for (const Face& face : surface.faces()) {
        const int first = static_cast<int>(soup.points.size());
        for (int v : face) soup.points.push_back(surface.point(v));
        soup.faces.push_back({first, first + 1, first + 2});
    }
    return soup;
}

WeldedMesh welded(const Soup& soup, Warnings* warnings = nullptr) {
    Warnings own;
    return weld(soup.points, soup.faces, warnings ? *warnings : own);
}

/// Corners stay where they were: what every weld must keep.
void expect_same_corners(const Soup& soup, const WeldedMesh& mesh) {
    ASSERT_EQ(mesh.raw_to_welded.size(), soup.faces.size());
    ASSERT_EQ(static_cast<int>(mesh.face_raw.size()), mesh.surface.face_count());
    EXPECT_TRUE(std::is_sorted(mesh.face_raw.begin(), mesh.face_raw.end()));
    std::vector<char> kept(soup.faces.size(), 0);
    for (int f = 0; f < mesh.surface.face_count(); ++f) {
        const int raw = mesh.face_raw[f];
        kept[raw] = 1;
        EXPECT_EQ(mesh.raw_to_welded[raw], mesh.surface.face(f));
        for (int k = 0; k < 3; ++k) EXPECT_EQ(mesh.surface.point(mesh.surface.face(f)[k]), soup.points[soup.faces[raw][k]]);
    }
    for (std::size_t f = 0; f < kept.size(); ++f)
        if (!kept[f]) {
            EXPECT_EQ(mesh.raw_to_welded[f], (Face{none, none, none}));
        }
}

TEST(Weld, ClosesASplitCube) {
    // As exporters write it: four vertices a side, for the normals.
    Soup soup;
    for (int axis = 0; axis < 3; ++axis)
        for (const double side : {0.0, 1.0}) {
            const int first = static_cast<int>(soup.points.size());
            for (int i = 0; i < 4; ++i) {
                Point p;
                p[axis] = side;
                p[(axis + 1) % 3] = i & 1;
                p[(axis + 2) % 3] = i >> 1;
                soup.points.push_back(p);
            }
            const int turn = side == 0;  // seen from outside
            soup.faces.push_back({first, first + (turn ? 2 : 1), first + 3});
            soup.faces.push_back({first, first + 3, first + (turn ? 1 : 2)});
        }
    ASSERT_EQ(soup.points.size(), 24u);
    Warnings warnings;
    const WeldedMesh mesh = welded(soup, &warnings);
    EXPECT_TRUE(warnings.empty());
    EXPECT_EQ(mesh.surface.vertex_count(), 8);
    EXPECT_EQ(border_edges(mesh.surface), 0);
    EXPECT_EQ(euler(mesh.surface), 2);
    EXPECT_DOUBLE_EQ(mesh.surface.area(), 6);
    expect_same_corners(soup, mesh);
}

TEST(Weld, MendsEverySeam) {
    for (const Surface& surface : {fixtures::icosphere(4), fixtures::torus(8, 12), fixtures::plane(6, 5)}) {
        const Soup soup = torn(surface);
        Warnings warnings;
        const WeldedMesh mesh = welded(soup, &warnings);
        EXPECT_TRUE(warnings.empty());
        EXPECT_EQ(mesh.surface.vertex_count(), surface.vertex_count());
        EXPECT_EQ(border_edges(mesh.surface), border_edges(surface));
        EXPECT_EQ(euler(mesh.surface), euler(surface));
        EXPECT_EQ(mesh.surface.area(), surface.area());  // the same faces in the same order: the same sum
        expect_same_corners(soup, mesh);
    }
}

TEST(Weld, OnlyEqualPositionsAreOne) {
    const double next = std::nextafter(1.0, 2.0);
    const Soup zero{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0, -0.0, 0}, {1, -0.0, -0.0}, {0, -1, 0}}, {{0, 1, 2}, {4, 3, 5}}};
    EXPECT_EQ(welded(zero).surface.vertex_count(), 4);  // -0 is 0
    const Soup close{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {next, 0, 0}, {0, -1, 0}}, {{0, 1, 2}, {4, 3, 5}}};
    EXPECT_EQ(euler(welded(close).surface), 2);  // two triangles: the last bit tells 1 from its neighbour
    EXPECT_EQ(face_components(welded(close).surface).back(), 1);
}

TEST(Weld, LeavesOutFacesWithoutArea) {
    Soup soup = torn(fixtures::icosphere(2));
    const Point a = soup.points[0], b = soup.points[1];
    const int first = static_cast<int>(soup.points.size());
    soup.points.insert(soup.points.end(), {a, b, a, Point(0, 0, 0), Point(1, 0, 0), Point(3, 0, 0)});
    soup.faces.insert(soup.faces.begin() + 1, {first, first + 1, first + 2});  // two corners in one place
    soup.faces.push_back({first + 3, first + 4, first + 5});                   // on a line
    Warnings warnings;
    const WeldedMesh mesh = welded(soup, &warnings);
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_TRUE(contains(warnings[0], "2 triangles have no area")) << warnings[0];
    EXPECT_EQ(mesh.raw_to_welded[1], (Face{none, none, none}));
    EXPECT_EQ(mesh.raw_to_welded.back(), (Face{none, none, none}));
    EXPECT_EQ(border_edges(mesh.surface), 0);
    expect_same_corners(soup, mesh);
}

TEST(Weld, CutsWhereThreeFacesMeet) {
    Soup soup{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}}, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}};
    Warnings warnings;
    const WeldedMesh mesh = welded(soup, &warnings);
    ASSERT_EQ(mesh.non_manifold_edges.size(), 1u);
    EXPECT_EQ(mesh.non_manifold_edges[0][0] + mesh.non_manifold_edges[0][1], Point(1, 0, 0));
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_TRUE(contains(warnings[0], "not manifold")) << warnings[0];
    EXPECT_EQ(mesh.surface.vertex_count(), 9);  // three triangles apart
    expect_same_corners(soup, mesh);
}

TEST(Weld, CutsWhereTheOrientationTurns) {
    const Soup soup{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}}, {{0, 1, 2}, {0, 1, 3}}};
    Warnings warnings;
    const WeldedMesh mesh = welded(soup, &warnings);
    EXPECT_EQ(mesh.non_manifold_edges.size(), 1u);
    EXPECT_EQ(warnings.size(), 1u);
    EXPECT_EQ(mesh.surface.vertex_count(), 6);
    expect_same_corners(soup, mesh);
}

TEST(Weld, CutsOffADuplicateFace) {
    Soup soup = torn(fixtures::icosphere(2));
    const std::size_t before = soup.faces.size();
    soup.faces.push_back(soup.faces[5]);
    Warnings warnings;
    const WeldedMesh mesh = welded(soup, &warnings);
    EXPECT_EQ(mesh.non_manifold_edges.size(), 3u);  // its three edges have three faces each
    EXPECT_EQ(warnings.size(), 1u);
    EXPECT_EQ(mesh.surface.face_count(), static_cast<int>(before) + 1);
    int parts = 0;
    face_components(mesh.surface, &parts);
    EXPECT_EQ(parts, 3);  // both copies and the sphere without them
    expect_same_corners(soup, mesh);
}

TEST(Weld, PullsABowTieApart) {
    const Soup soup{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}}, {{0, 1, 2}, {0, 3, 4}}};
    Warnings warnings;
    const WeldedMesh mesh = welded(soup, &warnings);
    EXPECT_TRUE(mesh.non_manifold_edges.empty());
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_TRUE(contains(warnings[0], "6 vertices at 5 positions")) << warnings[0];
    EXPECT_EQ(mesh.surface.vertex_count(), 6);
    EXPECT_NE(mesh.raw_to_welded[0][0], mesh.raw_to_welded[1][0]);
    expect_same_corners(soup, mesh);
}

TEST(Weld, DoesNotDependOnTheOrder) {
    // A sphere with a fin (three faces at an edge), a bow tie and a sliver without area.
    Soup soup = torn(fixtures::icosphere(3));
    const int first = static_cast<int>(soup.points.size());
    soup.points.insert(soup.points.end(), {soup.points[0], soup.points[1], Point(2, 2, 2), Point(3, 2, 2), Point(2, 3, 2),
                                           Point(0, 0, 9), Point(0, 0, 9)});
    soup.faces.push_back({first, first + 1, first + 2});
    soup.faces.push_back({first + 2, first + 3, first + 4});
    soup.faces.push_back({first + 5, first + 6, first});
    Warnings expected_warnings;
    const WeldedMesh expected = welded(soup, &expected_warnings);
    fixtures::Random random(11);
    for (int trial = 0; trial < 5; ++trial) {
        Soup mixed = soup;
        std::vector<int> number(soup.points.size());
        std::iota(number.begin(), number.end(), 0);
        for (int i = static_cast<int>(number.size()) - 1; i > 0; --i) std::swap(number[i], number[random.below(i + 1)]);
        for (std::size_t v = 0; v < number.size(); ++v) mixed.points[number[v]] = soup.points[v];
        for (Face& face : mixed.faces) {
            const int k = random.below(3);
            face = {number[face[k]], number[face[(k + 1) % 3]], number[face[(k + 2) % 3]]};
        }
        for (int i = static_cast<int>(mixed.faces.size()) - 1; i > 0; --i)
            std::swap(mixed.faces[i], mixed.faces[random.below(i + 1)]);
        Warnings warnings;
        const WeldedMesh mesh = welded(mixed, &warnings);
        EXPECT_EQ(mesh.surface.vertex_count(), expected.surface.vertex_count());
        EXPECT_EQ(mesh.surface.face_count(), expected.surface.face_count());
        EXPECT_EQ(border_edges(mesh.surface), border_edges(expected.surface));
        EXPECT_EQ(mesh.non_manifold_edges.size(), expected.non_manifold_edges.size());
        EXPECT_EQ(warnings, expected_warnings);
        expect_same_corners(mixed, mesh);
    }
}

/// What holds for every refinement of a surface.
void expect_refinement(const Surface& parent, const RefinedSurface& fine) {
    const Surface& surface = fine.surface;
    EXPECT_NEAR(surface.area(), parent.area(), 1e-13 * parent.area());  // sums in another order
    EXPECT_EQ(euler(surface), euler(parent));
    if (border_edges(parent) == 0) {
        EXPECT_EQ(border_edges(surface), 0);  // a T-junction would open it
    }
    ASSERT_EQ(static_cast<int>(fine.map.vertex.size()), surface.vertex_count());
    ASSERT_EQ(static_cast<int>(fine.map.face.size()), surface.face_count());
    ASSERT_GE(surface.vertex_count(), parent.vertex_count());
    for (int v = 0; v < parent.vertex_count(); ++v) {
        EXPECT_TRUE(same_bits(surface.point(v), parent.point(v)));
        EXPECT_TRUE(fine.map.vertex[v].is_vertex());
        EXPECT_EQ(fine.map.vertex[v].vertex[0], v);
        EXPECT_EQ(fine.map.vertex[v].weight[0], 1);
    }
    const double rounding = 1e-15 * 4 * parent.diagonal();
    for (int v = 0; v < surface.vertex_count(); ++v) {
        const VertexOrigin& origin = fine.map.vertex[v];
        Point at = Point::Zero();
        double sum = 0;
        bool ended = false;
        for (int i = 0; i < 3; ++i) {
            ended = ended || origin.vertex[i] == none;
            EXPECT_EQ(origin.vertex[i] == none, ended);  // used slots come first
            EXPECT_EQ(origin.weight[i] > 0, !ended);
            if (ended)
                continue;
            at += origin.weight[i] * parent.point(origin.vertex[i]);
            sum += origin.weight[i];
        }
        EXPECT_LE((at - surface.point(v)).norm(), rounding);
        EXPECT_DOUBLE_EQ(sum, 1);
    }
    std::vector<double> area(parent.face_count(), 0);
    for (int f = 0; f < surface.face_count(); ++f) {
        const int from = fine.map.face[f];
        area[from] += surface.face_area(f);
        EXPECT_GT(surface.face_normal(f).dot(parent.face_normal(from)), 0.99);
        // All corners lie on the parent face.
        const std::set<int> corners(parent.face(from).begin(), parent.face(from).end());
        for (int v : surface.face(f))
            for (int vertex : fine.map.vertex[v].vertex) EXPECT_TRUE(vertex == none || corners.contains(vertex));
    }
    for (int f = 0; f < parent.face_count(); ++f) EXPECT_NEAR(area[f], parent.face_area(f), 1e-12 * parent.face_area(f));
}

TEST(Subdivide, QuartersEveryFace) {
    for (const Surface& surface : {fixtures::cuboid(1, 2, 3), fixtures::torus(5, 7), fixtures::plane(3, 2)})
        for (int levels = 0; levels <= 3; ++levels) {
            const RefinedSurface fine = subdivide(surface, levels);
            EXPECT_EQ(fine.surface.face_count(), surface.face_count() << (2 * levels));
            EXPECT_EQ(border_edges(fine.surface), border_edges(surface) << levels);
            expect_refinement(surface, fine);
        }
}

double longest_edge(const Surface& surface) {
    double longest = 0;
    for (int h = 0; h < surface.halfedge_count(); ++h) longest = std::max(longest, surface.length(h));
    return longest;
}

TEST(SubdivideTo, LeavesNoLongEdge) {
    for (const Surface& surface :
         {fixtures::cuboid(1, 2, 3), fixtures::cuboid(0.05, 1, 4), fixtures::torus(5, 7), fixtures::irregular_plane(6, 6)})
        for (const double max_edge : {10.0, 0.7, 0.31, 0.1}) {
            const RefinedSurface fine = subdivide_to(surface, max_edge);
            EXPECT_LE(longest_edge(fine.surface), max_edge);
            if (longest_edge(surface) <= max_edge) {
                EXPECT_EQ(fine.surface.face_count(), surface.face_count());
            }
            expect_refinement(surface, fine);
        }
}

TEST(SubdivideTo, SplitsOnlyWhereEdgesAreLong) {
    // A long face beside a short one: the short one's own edges stay.
    const Surface surface({{0, 0, 0}, {0.1, 0, 0}, {0.05, 0.1, 0}, {0.05, -3, 0}}, {{0, 1, 2}, {1, 0, 3}});
    const RefinedSurface fine = subdivide_to(surface, 0.2);
    int of_short = 0;
    for (int face : fine.map.face) of_short += face == 0;
    EXPECT_EQ(of_short, 1);
    expect_refinement(surface, fine);
}

TEST(SubdivideTo, RefusesWhatDoesNotFit) {
    const Surface cube = fixtures::cuboid();
    const std::string message = refusal([&] { subdivide_to(cube, 1e-5); });
    EXPECT_TRUE(contains(message, "50 million")) << message;
    // The predicted number stands in the message: 6 / (1e-5)^2 x 4 / 2 is of the order of 10^11.
    const std::size_t digits = message.find_first_of("0123456789");
    ASSERT_NE(digits, std::string::npos);
    EXPECT_GT(std::stod(message.substr(digits)), 1e10);
    EXPECT_TRUE(contains(refusal([&] { subdivide(cube, 12); }), "50 million"));
    for (const double bad : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
        EXPECT_TRUE(contains(refusal([&] { subdivide_to(cube, bad); }), "max_edge"));
}

TEST(SurfaceMap, IdentityMapsToItself) {
    const Surface surface = fixtures::icosphere(2);
    expect_refinement(surface, {surface, identity_map(surface)});
}

TEST(SurfaceMap, ComposedWeightsReproduceTheGrandchild) {
    // Children with vertices inside faces and on edges, grandchildren across all of them.
    const Surface surface = fixtures::torus(5, 7);
    RefinedSurface child{surface, identity_map(surface)};
    {
        std::vector<Point> points = surface.points();
        std::vector<Face> faces;
        child.map.face.clear();
        for (int f = 0; f < surface.face_count(); ++f) {
            const auto& [a, b, c] = surface.face(f);
            const int middle = static_cast<int>(points.size());
            points.push_back(0.2 * surface.point(a) + 0.3 * surface.point(b) + 0.5 * surface.point(c));
            child.map.vertex.push_back({{a, b, c}, {0.2, 0.3, 0.5}});
            for (const Face& part : {Face{a, b, middle}, Face{b, c, middle}, Face{c, a, middle}}) {
                faces.push_back(part);
                child.map.face.push_back(f);
            }
        }
        child.surface = Surface(std::move(points), std::move(faces));
    }
    expect_refinement(surface, child);
    for (const RefinedSurface& grandchild : {subdivide(child.surface, 2), subdivide_to(child.surface, 0.15)}) {
        const SurfaceMap map = compose(child.map, grandchild.map);
        expect_refinement(surface, {grandchild.surface, map});
    }
    // Composing with the identity changes nothing, from either side.
    for (const SurfaceMap& map : {compose(child.map, identity_map(child.surface)), compose(identity_map(surface), child.map)}) {
        EXPECT_EQ(map.face, child.map.face);
        for (std::size_t v = 0; v < map.vertex.size(); ++v) {
            EXPECT_EQ(map.vertex[v].vertex, child.map.vertex[v].vertex);
            EXPECT_EQ(map.vertex[v].weight, child.map.vertex[v].weight);
        }
    }
}

}  // namespace
}  // namespace pvg::test
