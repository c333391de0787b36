// Imprinting: laws that hold after any curve, the cases where curves meet, and random stress.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>
#include <set>

#include "curves/imprint.h"
#include "fixtures/meshes.h"
#include "pvg/status.h"

namespace pvg {
namespace {

using fixtures::Random;

std::vector<double> even(const SurfacePath& path) {
    std::vector<double> t(path.points.size());
    const double pieces = path.closed ? path.points.size() : std::max<double>(1, path.points.size() - 1.0);
    for (std::size_t i = 0; i < t.size(); ++i) t[i] = i / pieces;
    return t;
}

int euler_characteristic(const Surface& surface) {
    int edges = 0, used = 0;
    for (int h = 0; h < surface.halfedge_count(); ++h)
        if (surface.twin(h) == none || surface.twin(h) > h)
            ++edges;
    for (int v = 0; v < surface.vertex_count(); ++v) used += surface.outgoing(v) != none;
    return used - edges + surface.face_count();
}

Eigen::Vector3d bary_in_parent(const Surface& parent, int face, const VertexOrigin& origin) {
    Eigen::Vector3d bary(0, 0, 0);
    double found = 0;
    for (int i = 0; i < 3 && origin.vertex[i] != none; ++i)
        for (int k = 0; k < 3; ++k)
            if (parent.face(face)[k] == origin.vertex[i]) {
                bary[k] = origin.weight[i];
                found += origin.weight[i];
            }
    EXPECT_NEAR(found, 1, 1e-14) << "a vertex is not on the parent face of its face";
    return bary;
}

/// Everything that holds whatever was imprinted.
void expect_lawful(const Surface& parent, const Imprinter& imprinter) {
    const RefinedSurface refined = imprinter.surface();
    const Surface& s = refined.surface;
    ASSERT_EQ(refined.map.vertex.size(), static_cast<std::size_t>(s.vertex_count()));
    ASSERT_EQ(refined.map.face.size(), static_cast<std::size_t>(s.face_count()));
    // Each part's area is rounded once.
    EXPECT_NEAR(s.area(), parent.area(), 1e-12 * parent.area());
    EXPECT_EQ(euler_characteristic(s), euler_characteristic(parent));
    for (int v = 0; v < parent.vertex_count(); ++v) {
        ASSERT_EQ(s.point(v), parent.point(v));
        ASSERT_TRUE(refined.map.vertex[v].is_vertex());
        ASSERT_EQ(refined.map.vertex[v].vertex[0], v);
    }
    for (int v = 0; v < s.vertex_count(); ++v) {
        const VertexOrigin& origin = refined.map.vertex[v];
        Point at = Point::Zero();
        double sum = 0;
        for (int i = 0; i < 3 && origin.vertex[i] != none; ++i) {
            at += origin.weight[i] * parent.point(origin.vertex[i]);
            sum += origin.weight[i];
            ASSERT_GT(origin.weight[i], 0);
        }
        ASSERT_NEAR(sum, 1, 1e-15 * 4);
        ASSERT_EQ((at - s.point(v)).norm(), 0) << "vertex " << v;
        ASSERT_EQ(origin.is_vertex(), v < parent.vertex_count());
    }
    std::vector<int> parts(parent.face_count(), 0);
    for (int f : refined.map.face) ++parts[f];
    std::vector<double> share(parent.face_count(), 0);
    for (int f = 0; f < s.face_count(); ++f) {
        const int p = refined.map.face[f];
        if (parts[p] == 1) {
            ASSERT_EQ(f, p);
            ASSERT_EQ(s.face(f), parent.face(f)) << "an untouched face changed";
        }
        Eigen::Matrix3d M;
        for (int k = 0; k < 3; ++k) M.row(k) = bary_in_parent(parent, p, refined.map.vertex[s.face(f)[k]]);
        const Eigen::Vector3d u = M.row(1) - M.row(0), w = M.row(2) - M.row(0);
        const double area = u[0] * w[1] - u[1] * w[0];
        ASSERT_GT(area, 0) << "face " << f << " in parent face " << p << " is turned over";
        share[p] += area;
    }
    for (int p = 0; p < parent.face_count(); ++p) ASSERT_NEAR(share[p], 1, 1e-12);
    for (int c = 0; c < imprinter.chain_count(); ++c) {
        const CurveChain chain = imprinter.chain(c);
        const std::size_t n = chain.vertices.size();
        ASSERT_GE(n, chain.closed ? 3u : 2u);
        ASSERT_EQ(chain.t.size(), n);
        for (std::size_t i = 0; i < n; ++i) {
            if (i + 1 == n && !chain.closed)
                break;
            const int a = chain.vertices[i], b = chain.vertices[(i + 1) % n];
            ASSERT_NE(a, b);
            ASSERT_TRUE(s.halfedge_between(a, b) != none || s.halfedge_between(b, a) != none)
                << "chain " << c << " is torn at " << i;
            ASSERT_GE(chain.t[(i + 1) % n], i + 1 < n ? chain.t[i] : 0);
        }
        ASSERT_LE(chain.t.back(), 1);
    }
}

/// A path through the surface's points at positions in the plane z = 0: cut at every edge by walking straight lines.
SurfacePath straight_in_plane(const Surface& flat, const std::vector<Eigen::Vector2d>& corners, bool closed) {
    SurfacePath path;
    path.closed = closed;
    const std::size_t pieces = closed ? corners.size() : corners.size() - 1;
    for (std::size_t i = 0; i < pieces; ++i) {
        const Eigen::Vector2d a = corners[i], b = corners[(i + 1) % corners.size()];
        // Crossings with all edges, sorted along the piece.
        std::vector<std::pair<double, SurfacePoint>> on;
        for (int h = 0; h < flat.halfedge_count(); ++h) {
            if (flat.twin(h) != none && flat.twin(h) < h)
                continue;
            const Eigen::Vector2d u = flat.point(flat.origin(h)).head<2>(), w = flat.point(flat.target(h)).head<2>();
            const Eigen::Vector2d d = b - a, e = w - u;
            const double det = d.x() * e.y() - d.y() * e.x();
            if (std::abs(det) < 1e-12 * d.norm() * e.norm())
                continue;
            const Eigen::Vector2d g = u - a;
            const double along = (g.x() * e.y() - g.y() * e.x()) / det, across = (g.x() * d.y() - g.y() * d.x()) / det;
            if (along <= 1e-9 || along >= 1 - 1e-9 || across < -1e-9 || across > 1 + 1e-9)
                continue;
            SurfacePoint at{h / 3, {0, 0, 0}};
            const double s = across < 1e-9 ? 0 : across > 1 - 1e-9 ? 1 : across;
            at.bary[h % 3] = 1 - s;
            at.bary[(h % 3 + 1) % 3] = s;
            on.emplace_back(along, at);
        }
        std::sort(on.begin(), on.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
        path.points.push_back(fixtures::locate_flat(flat, a.x(), a.y()));
        for (std::size_t k = 0; k < on.size(); ++k)
            if (k == 0 || on[k].first - on[k - 1].first > 1e-9)
                path.points.push_back(on[k].second);
    }
    if (!closed)
        path.points.push_back(fixtures::locate_flat(flat, corners.back().x(), corners.back().y()));
    return path;
}

double chain_length(const Surface& surface, const CurveChain& chain) {
    double sum = 0;
    for (std::size_t i = 0; i + (chain.closed ? 0 : 1) < chain.vertices.size(); ++i)
        sum += (surface.point(chain.vertices[(i + 1) % chain.vertices.size()]) - surface.point(chain.vertices[i])).norm();
    return sum;
}

int draw(Imprinter& imprinter, const Surface& flat, const std::vector<Eigen::Vector2d>& corners, bool closed = false) {
    const SurfacePath path = straight_in_plane(flat, corners, closed);
    return imprinter.imprint(path, even(path));
}

int shared_vertices(const CurveChain& a, const CurveChain& b) {
    const std::set<int> of_a(a.vertices.begin(), a.vertices.end());
    return static_cast<int>(std::count_if(b.vertices.begin(), b.vertices.end(), [&](int v) { return of_a.count(v) > 0; }));
}

TEST(Imprint, NothingImprintedIsTheParent) {
    const Surface parent = fixtures::torus(7, 5);
    const Imprinter imprinter(parent);
    expect_lawful(parent, imprinter);
    EXPECT_EQ(imprinter.surface().surface.faces(), parent.faces());
    EXPECT_EQ(imprinter.chain_count(), 0);
}

TEST(Imprint, StraightLineAcrossThePlane) {
    const Surface parent = fixtures::irregular_plane(9, 9);
    Imprinter imprinter(parent);
    const int c = draw(imprinter, parent, {{0.11, 0.17}, {0.83, 0.91}});
    expect_lawful(parent, imprinter);
    const RefinedSurface refined = imprinter.surface();
    const CurveChain chain = imprinter.chain(c);
    EXPECT_TRUE(imprinter.is_simple(c));
    EXPECT_EQ(chain.t.front(), 0);
    EXPECT_EQ(chain.t.back(), 1);
    // Snapping moves a point by at most 0.05 of an edge (longest here: 0.2).
    for (int v : chain.vertices) {
        const Eigen::Vector2d d = refined.surface.point(v).head<2>() - Eigen::Vector2d(0.11, 0.17);
        EXPECT_LT(std::abs(d.x() * 0.74 - d.y() * 0.72) / std::hypot(0.74, 0.72), 0.05 * 0.2);
    }
    // Parents off the line have one part each.
    EXPECT_LT(refined.surface.face_count(), parent.face_count() + 100);
}

TEST(Imprint, CurvesThatCrossShareOneVertex) {
    for (bool coarse : {true, false}) {
        const Surface parent = coarse ? fixtures::plane(1, 1) : fixtures::irregular_plane(8, 8);
        Imprinter imprinter(parent);
        const int a = draw(imprinter, parent, {{0.07, 0.21}, {0.93, 0.73}});
        const std::size_t before = imprinter.chain(a).vertices.size();
        const int b = draw(imprinter, parent, {{0.13, 0.81}, {0.86, 0.09}});
        expect_lawful(parent, imprinter);
        EXPECT_EQ(shared_vertices(imprinter.chain(a), imprinter.chain(b)), 1);
        EXPECT_LE(imprinter.chain(a).vertices.size(), before + 1);
        EXPECT_TRUE(imprinter.is_simple(a) && imprinter.is_simple(b));
    }
}

TEST(Imprint, SplitChainKeepsItsParameterLinear) {
    const Surface parent = fixtures::plane(1, 1);
    Imprinter imprinter(parent);
    const int a = draw(imprinter, parent, {{0.1, 0.02}, {0.9, 0.02}});
    for (int i = 1; i < 8; ++i) draw(imprinter, parent, {{0.1 + 0.1 * i, 0.01}, {0.1 + 0.1 * i, 0.3}});
    expect_lawful(parent, imprinter);
    const CurveChain chain = imprinter.chain(a);
    const Surface s = imprinter.surface().surface;
    EXPECT_EQ(chain.vertices.size(), 9u);
    for (std::size_t i = 0; i < chain.vertices.size(); ++i)
        EXPECT_NEAR(chain.t[i], (s.point(chain.vertices[i]).x() - 0.1) / 0.8, 1e-12);
}

TEST(Imprint, ClosedLoopInsideOneFace) {
    const Surface parent = fixtures::cuboid();
    Imprinter imprinter(parent);
    // Face 2 = (4, 5, 7): three nested triangles and a small loop with many points, all inside it.
    for (double shrink : {0.8, 0.6, 0.3}) {
        SurfacePath path;
        path.closed = true;
        for (int k = 0; k < 3; ++k) {
            Eigen::Vector3d bary = Eigen::Vector3d::Constant((1 - shrink) / 3);
            bary[k] += shrink;
            path.points.push_back({2, bary});
        }
        imprinter.imprint(path, even(path));
    }
    SurfacePath circle;
    circle.closed = true;
    for (int i = 0; i < 200; ++i) {
        const double a = 2 * std::numbers::pi * i / 200;
        const double x = 0.05 * std::cos(a), y = 0.05 * std::sin(a);
        circle.points.push_back({2, {1 / 3.0 + x, 1 / 3.0 + y, 1 / 3.0 - x - y}});
    }
    imprinter.imprint(circle, even(circle));
    expect_lawful(parent, imprinter);
    for (int c = 0; c < 4; ++c) EXPECT_TRUE(imprinter.is_simple(c));
    EXPECT_EQ(imprinter.chain(0).vertices.size(), 3u);
    EXPECT_EQ(imprinter.chain(3).vertices.size(), 200u);
    const RefinedSurface refined = imprinter.surface();
    // Inside one face only that face is split: every path point is a vertex, and the 11 other faces are as they were.
    EXPECT_EQ(refined.surface.vertex_count(), 8 + 9 + 200);
    EXPECT_EQ(refined.surface.face_count(), 12 + 2 * 209);
    EXPECT_NEAR(chain_length(refined.surface, imprinter.chain(0)), 0.8 * (2 + std::sqrt(2.0)), 1e-12);
}

TEST(Imprint, LoopsThatShareOneCoarseFaceCross) {
    const Surface parent = fixtures::plane(1, 1);
    Imprinter imprinter(parent);
    for (int i = 0; i < 6; ++i) {
        const double x = 0.2 + 0.1 * i, y = 0.25 + 0.09 * i;
        draw(imprinter, parent, {{x - 0.15, y - 0.2}, {x + 0.17, y - 0.13}, {x + 0.1, y + 0.21}, {x - 0.12, y + 0.14}}, true);
    }
    expect_lawful(parent, imprinter);
    for (int c = 0; c < 6; ++c) EXPECT_TRUE(imprinter.is_simple(c)) << c;
    for (int c = 0; c + 1 < 6; ++c) EXPECT_EQ(shared_vertices(imprinter.chain(c), imprinter.chain(c + 1)), 2) << c;
}

TEST(Imprint, ThroughVerticesAndAlongParentEdges) {
    const Surface parent = fixtures::plane(4, 4);
    for (double angle : {0.0, 0.7, 2.1}) {
        const Surface turned = fixtures::rotated(parent, angle);
        Imprinter imprinter(turned);
        SurfacePath along = straight_in_plane(parent, {{0.0, 0.5}, {1.0, 0.5}}, false);         // a row of edges
        SurfacePath diagonal = straight_in_plane(parent, {{0.25, 0.25}, {0.75, 0.75}}, false);  // through vertices
        const int a = imprinter.imprint(along, even(along));
        const int b = imprinter.imprint(diagonal, even(diagonal));
        expect_lawful(turned, imprinter);
        EXPECT_EQ(imprinter.chain(a).vertices, (std::vector<int>{10, 11, 12, 13, 14}));
        const std::vector<int> of_b = imprinter.chain(b).vertices;
        EXPECT_EQ(of_b.front(), 6);
        EXPECT_EQ(of_b.back(), 18);
        EXPECT_EQ(std::count(of_b.begin(), of_b.end(), 12), 1);
        // Nothing was there to split but diagonals that run the other way.
        EXPECT_LE(imprinter.surface().surface.vertex_count(), turned.vertex_count() + 2);
    }
}

TEST(Imprint, SameCurveAgainSharesAllEdges) {
    for (double angle : {0.0, 1.3}) {
        const Surface parent = fixtures::rotated(fixtures::irregular_plane(6, 6), angle);
        const Surface flat = fixtures::irregular_plane(6, 6);
        const SurfacePath path = straight_in_plane(flat, {{0.13, 0.18}, {0.81, 0.33}, {0.47, 0.92}}, true);
        Imprinter imprinter(parent);
        const int a = imprinter.imprint(path, even(path));
        const int vertices = imprinter.surface().surface.vertex_count();
        const int b = imprinter.imprint(path, even(path));
        expect_lawful(parent, imprinter);
        EXPECT_EQ(imprinter.surface().surface.vertex_count(), vertices);
        EXPECT_EQ(imprinter.chain(a).vertices, imprinter.chain(b).vertices);
        // The other way round, and a part of it.
        SurfacePath back = path;
        std::reverse(back.points.begin(), back.points.end());
        const int c = imprinter.imprint(back, even(back));
        SurfacePath part;
        part.points.assign(path.points.begin() + 2, path.points.begin() + 7);
        const int d = imprinter.imprint(part, even(part));
        expect_lawful(parent, imprinter);
        EXPECT_EQ(imprinter.surface().surface.vertex_count(), vertices);
        EXPECT_EQ(shared_vertices(imprinter.chain(a), imprinter.chain(c)), static_cast<int>(imprinter.chain(a).vertices.size()));
        EXPECT_EQ(shared_vertices(imprinter.chain(a), imprinter.chain(d)), static_cast<int>(imprinter.chain(d).vertices.size()));
    }
}

TEST(Imprint, OverlappingCollinearCurvesShareEdgesInsideAFace) {
    const Surface parent = fixtures::plane(1, 1);
    Imprinter imprinter(parent);
    const int a = draw(imprinter, parent, {{0.2, 0.1}, {0.9, 0.31}});
    const int b = draw(imprinter, parent, {{0.4, 0.16}, {0.8, 0.28}});
    const int c = draw(imprinter, parent, {{0.95, 0.325}, {0.5, 0.19}});
    expect_lawful(parent, imprinter);
    EXPECT_EQ(shared_vertices(imprinter.chain(a), imprinter.chain(b)), static_cast<int>(imprinter.chain(b).vertices.size()));
    EXPECT_EQ(shared_vertices(imprinter.chain(a), imprinter.chain(c)), static_cast<int>(imprinter.chain(c).vertices.size()) - 1);
}

TEST(Imprint, TouchingCurveMeetsInOneVertex) {
    const Surface parent = fixtures::plane(2, 2);
    Imprinter imprinter(parent);
    const int a = draw(imprinter, parent, {{0.1, 0.4}, {0.9, 0.42}});
    const int b = draw(imprinter, parent, {{0.3, 0.1}, {0.5, 0.41}, {0.7, 0.1}});  // its corner stands on a
    const int c = draw(imprinter, parent, {{0.6, 0.9}, {0.7, 0.415}});             // ends on a
    expect_lawful(parent, imprinter);
    EXPECT_EQ(shared_vertices(imprinter.chain(a), imprinter.chain(b)), 1);
    EXPECT_EQ(shared_vertices(imprinter.chain(a), imprinter.chain(c)), 1);
}

TEST(Imprint, UTurnsRepeatedPointsAndZeroLengthPieces) {
    const Surface parent = fixtures::plane(3, 3);
    Imprinter imprinter(parent);
    const int a = draw(imprinter, parent, {{0.1, 0.2}, {0.8, 0.25}, {0.3, 0.2142857142857143}});  // back over itself
    SurfacePath path = straight_in_plane(parent, {{0.2, 0.7}, {0.7, 0.8}}, false);
    SurfacePath doubled;
    for (const SurfacePoint& p : path.points) doubled.points.insert(doubled.points.end(), 3, p);
    const int b = imprinter.imprint(doubled, even(doubled));
    expect_lawful(parent, imprinter);
    EXPECT_FALSE(imprinter.is_simple(a));
    EXPECT_TRUE(imprinter.is_simple(b));
    EXPECT_EQ(imprinter.chain(b).t.front(), 0);
    EXPECT_EQ(imprinter.chain(b).t.back(), 1);
    // Loops that cross themselves are told.
    const int eight = draw(imprinter, parent, {{0.1, 0.1}, {0.9, 0.9}, {0.9, 0.1}, {0.1, 0.9}}, true);
    expect_lawful(parent, imprinter);
    EXPECT_FALSE(imprinter.is_simple(eight));
}

TEST(Imprint, TooSmallOrBrokenPathsAreRefused) {
    const Surface parent = fixtures::plane(4, 4);
    Imprinter imprinter(parent);
    const SurfacePath dot{{fixtures::locate_flat(parent, 0.3, 0.3), fixtures::locate_flat(parent, 0.3, 0.3)}, false};
    EXPECT_THROW(imprinter.imprint(dot, {0, 1}), Error);
    const SurfacePath lens{{fixtures::locate_flat(parent, 0.3, 0.3), fixtures::locate_flat(parent, 0.35, 0.3)}, true};
    EXPECT_THROW(imprinter.imprint(lens, {0, 0.5}), Error);
    const SurfacePath apart{{fixtures::locate_flat(parent, 0.1, 0.1), fixtures::locate_flat(parent, 0.9, 0.9)}, false};
    EXPECT_THROW(imprinter.imprint(apart, {0, 1}), Error);
    EXPECT_THROW(imprinter.imprint(apart, {0}), Error);
    EXPECT_THROW(imprinter.imprint({{{99, {1, 0, 0}}, {0, {1, 0, 0}}}, false}, {0, 1}), Error);
    EXPECT_THROW(imprinter.imprint({{{0, {2, -1, 0}}, {0, {1, 0, 0}}}, false}, {0, 1}), Error);
    EXPECT_THROW(imprinter.imprint({}, {}), Error);
    expect_lawful(parent, imprinter);  // what was refused leaves at most splits behind
    EXPECT_EQ(imprinter.chain_count(), 0);
}

TEST(Imprint, PointsNearAVertexSnapToIt) {
    const Surface parent = fixtures::plane(4, 4);  // shortest edges 0.25: the radius is 0.0125
    Imprinter imprinter(parent);
    const int near = draw(imprinter, parent, {{0.50, 0.512}, {0.9, 0.6}, {0.95, 0.9}});
    EXPECT_EQ(imprinter.chain(near).vertices.front(), 12);
    const int far = draw(imprinter, parent, {{0.25, 0.27}, {0.1, 0.35}});
    EXPECT_GE(imprinter.chain(far).vertices.front(), parent.vertex_count());
    const int passing = draw(imprinter, parent, {{0.05, 0.756}, {0.45, 0.754}, {0.45, 0.95}});
    const std::vector<int> on = imprinter.chain(passing).vertices;
    EXPECT_EQ(std::count(on.begin(), on.end(), 16), 1);
    expect_lawful(parent, imprinter);
}

TEST(Imprint, SmallCurveKeepsItsShapeBesideACoarseVertex) {
    const Surface parent = fixtures::plane(1, 1);  // 0.05 x the shortest edge would swallow it
    Imprinter imprinter(parent);
    std::vector<Eigen::Vector2d> corners;
    for (int i = 0; i < 40; ++i) {
        const double a = 2 * std::numbers::pi * i / 40;
        corners.emplace_back(0.02 + 0.01 * std::cos(a), 0.021 + 0.01 * std::sin(a));
    }
    const int c = draw(imprinter, parent, corners, true);
    expect_lawful(parent, imprinter);
    EXPECT_TRUE(imprinter.is_simple(c));
    EXPECT_GE(imprinter.chain(c).vertices.size(), 40u);
    EXPECT_NEAR(chain_length(imprinter.surface().surface, imprinter.chain(c)), 40 * 2 * 0.01 * std::sin(std::numbers::pi / 40),
                0.02 * 0.06);
}

TEST(Imprint, PathsOnTheImprintedSurfaceComeBackToTheParent) {
    const Surface parent = fixtures::rotated(fixtures::irregular_plane(6, 6), 0.6);
    const Surface flat = fixtures::irregular_plane(6, 6);
    Imprinter imprinter(parent);
    const SurfacePath path = straight_in_plane(flat, {{0.13, 0.18}, {0.81, 0.33}, {0.47, 0.92}}, true);
    imprinter.imprint(path, even(path));
    const RefinedSurface refined = imprinter.surface();
    for (int v = 0; v < refined.surface.vertex_count(); ++v)
        EXPECT_LT((parent.position(imprinter.parent_point(v)) - refined.surface.point(v)).norm(), 1e-15);
    SurfacePath across;
    for (int f = 0; f < refined.surface.face_count(); ++f) across.points.push_back({f, {0.2, 0.5, 0.3}});
    const SurfacePath back = to_parent(parent, refined, across);
    for (std::size_t i = 0; i < across.points.size(); ++i) {
        EXPECT_EQ(back.points[i].face, refined.map.face[i]);
        EXPECT_LT((parent.position(back.points[i]) - refined.surface.position(across.points[i])).norm(), 1e-15);
    }
}

/// Straight on over the edges from a point inside a face, `reach` far; stops early at a border.
SurfacePath traced(const Surface& surface, const SurfacePoint& from, double angle, double reach) {
    SurfacePath path{{from}, false};
    SurfacePoint at = from;
    Point direction;
    {
        const Point x = (surface.point(surface.face(at.face)[1]) - surface.point(surface.face(at.face)[0])).normalized();
        const Point n = surface.face_normal(at.face);
        direction = std::cos(angle) * x + std::sin(angle) * n.cross(x);
    }
    int entered = none;
    while (reach > 0) {
        const Point here = surface.position(at);
        const Point n = surface.face_normal(at.face);
        int leave = none;
        double best = std::numeric_limits<double>::infinity();
        for (int h = 3 * at.face; h < 3 * at.face + 3; ++h) {
            if (h == entered)
                continue;
            const Point outward = (surface.point(surface.target(h)) - surface.point(surface.origin(h))).cross(n).normalized();
            const double speed = outward.dot(direction);
            if (speed <= 1e-12)
                continue;
            const double step = std::max(0.0, outward.dot(surface.point(surface.origin(h)) - here)) / speed;
            if (step < best) {
                best = step;
                leave = h;
            }
        }
        if (leave == none)
            break;
        if (best >= reach) {
            const Face& f = surface.face(at.face);
            const Point end = here + reach * direction;
            Eigen::Matrix<double, 3, 2> E;
            E << surface.point(f[1]) - surface.point(f[0]), surface.point(f[2]) - surface.point(f[0]);
            const Eigen::Vector2d st = (E.transpose() * E).inverse() * (E.transpose() * (end - surface.point(f[0])));
            const Eigen::Vector3d bary = Eigen::Vector3d(1 - st.sum(), st[0], st[1]).cwiseMax(0);
            path.points.push_back({at.face, bary / bary.sum()});
            break;
        }
        const Point end = here + best * direction;
        const Point along = surface.point(surface.target(leave)) - surface.point(surface.origin(leave));
        const double s = std::clamp((end - surface.point(surface.origin(leave))).dot(along) / along.squaredNorm(), 0.0, 1.0);
        at.bary.setZero();
        at.bary[leave % 3] = 1 - s;
        at.bary[(leave % 3 + 1) % 3] = s;
        path.points.push_back(at);
        reach -= best;
        const int other = surface.twin(leave);
        if (other == none)
            break;
        const Point axis = along.normalized();
        // The part across the edge: away from the old face, into the new one.
        direction = axis.dot(direction) * axis + n.cross(axis).dot(direction) * surface.face_normal(other / 3).cross(axis);
        SurfacePoint next{other / 3, {0, 0, 0}};
        next.bary[other % 3] = s;
        next.bary[(other % 3 + 1) % 3] = 1 - s;
        at = next;
        entered = other;
    }
    return path;
}

SurfacePath random_path(const Surface& surface, Random& random, double reach, int bends) {
    Eigen::Vector3d bary(random.real(0.05, 1), random.real(0.05, 1), random.real(0.05, 1));
    SurfacePath path{{{random.below(surface.face_count()), bary / bary.sum()}}, false};
    for (int i = 0; i <= bends; ++i) {
        const SurfacePath more =
            traced(surface, path.points.back(), random.real(0, 2 * std::numbers::pi), reach * random.real(0.2, 1));
        path.points.insert(path.points.end(), more.points.begin() + 1, more.points.end());
        if (path.points.back().bary.minCoeff() == 0)
            break;  // at a border
    }
    return path;
}

void stress(const Surface& surface, int curves, double reach, int bends, std::uint64_t seed) {
    Random random(seed);
    Imprinter imprinter(surface);
    for (int i = 0; i < curves; ++i) {
        const SurfacePath path = random_path(surface, random, reach, bends);
        imprinter.imprint(path, even(path));
    }
    expect_lawful(surface, imprinter);
    EXPECT_EQ(imprinter.chain_count(), curves);
}

TEST(Imprint, NoVertexThatIsNeitherPointNorCrossing) {
    // A grid of lines: ends, crossings with the diagonal and with each other. Free edges in the way are flipped, not split.
    const Surface parent = fixtures::plane(1, 1);
    Imprinter imprinter(parent);
    for (int i = 0; i < 20; ++i) draw(imprinter, parent, {{0.02, 0.021 + 0.047 * i}, {0.98, 0.023 + 0.047 * i}});
    for (int i = 0; i < 20; ++i) draw(imprinter, parent, {{0.024 + 0.047 * i, 0.01}, {0.026 + 0.047 * i, 0.99}});
    expect_lawful(parent, imprinter);
    EXPECT_LE(imprinter.surface().surface.vertex_count(), 4 + 40 * 2 + 40 + 20 * 20);
}

TEST(Imprint, StressOnAnIcosphere) { stress(fixtures::rotated(fixtures::icosphere(8), 0.3), 200, 0.8, 3, 11); }
TEST(Imprint, StressOnACoarseCuboid) { stress(fixtures::rotated(fixtures::cuboid(1, 2, 0.7), 0.4), 200, 1.0, 3, 12); }
TEST(Imprint, StressOnAnOpenPlane) { stress(fixtures::rotated(fixtures::irregular_plane(5, 5), 0.9), 120, 0.7, 2, 13); }
TEST(Imprint, StressOnNeedles) { stress(fixtures::cuboid(1, 2, 1e-6), 30, 2.0, 4, 15); }
TEST(Imprint, StressFarFromTheOriginAndAtOtherScales) {
    const Surface ball = fixtures::icosphere(4);
    stress(fixtures::transformed(ball, [](const Point& p) -> Point { return p + Point(1000, 2000, -500); }), 30, 1.8, 3, 16);
    stress(fixtures::scaled(ball, 1e-5), 30, 1.8e-5, 3, 17);
    stress(fixtures::scaled(ball, 1e5), 30, 1.8e5, 3, 18);
}
TEST(Imprint, StressWithManyBendsInFewFaces) { stress(fixtures::cuboid(), 12, 0.15, 60, 14); }

TEST(Imprint, AnEndOnAnEarlierCurveStaysOnItBesideAVertex) {
    // The first curve passes a vertex that it is too short to snap to; the second is long enough, but ends on the first.
    const Surface surface = fixtures::plane(2, 2);
    Imprinter imprinter(surface);
    const auto at = [&](double x, double y) { return fixtures::locate_flat(surface, x, y); };
    const SurfacePoint begin = at(0.503, 0.501), end = at(0.6, 0.53);
    ASSERT_EQ(begin.face, end.face);
    const int first = imprinter.imprint({{begin, end}, false}, {0, 1});
    const SurfacePoint foot{begin.face, 0.94 * begin.bary + 0.06 * end.bary};
    const int second = imprinter.imprint({{at(0.98, 0.05), at(0.9, 0.5), foot}, false}, {0, 0.5, 1});
    const std::vector<int> vertices = imprinter.chain(first).vertices;
    EXPECT_NE(std::find(vertices.begin(), vertices.end(), imprinter.chain(second).vertices.back()), vertices.end());
}

TEST(Imprint, APathThatEndsWhereItBeganHasOneVertexThere) {
    // The first point snaps to the middle vertex; when the path comes back the edge that it made itself is too short for that.
    const Surface surface = fixtures::plane(2, 2);
    Imprinter imprinter(surface);
    const auto at = [&](double x, double y) { return fixtures::locate_flat(surface, x, y); };
    const SurfacePoint begin = at(0.51, 0.502);
    const int number =
        imprinter.imprint({{begin, at(0.53, 0.505), at(0.9, 0.8), at(0.7, 0.7), begin}, false}, {0, 0.1, 0.5, 0.8, 1});
    const CurveChain chain = imprinter.chain(number);
    EXPECT_EQ(chain.vertices.front(), chain.vertices.back());
}

}  // namespace
}  // namespace pvg
