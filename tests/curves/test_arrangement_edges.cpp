// Groups, slits and values where curves meet, end and overlap (the table in scenes/FORMAT.md), on chains of mesh edges.
#include <gtest/gtest.h>

#include "curves/arrangement.h"
#include "curves/region.h"
#include "curves/slit.h"
#include "edge_drawing.h"
#include "pvg/status.h"

namespace pvg::test {
namespace {

constexpr int n = 8;  // cells a side of the unit square
int at(int x, int y) { return y * (n + 1) + x; }
EdgeScene square() { return EdgeScene(fixtures::plane(n, n)); }
Color value_of(const Domain& d, int v) { return d.dirichlet_value.row(v).head(4).transpose(); }

std::string error_of(EdgeScene& scene) {
    try {
        scene.arrange();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::bad_input);
        return error.what();
    }
    return "";
}

/// Laws that hold for every arrangement.
void check_laws(const Arrangement& a) {
    EXPECT_EQ(a.output.face_count(), a.imprinted.surface.face_count());
    EXPECT_NEAR(a.output.area(), a.imprinted.surface.area(), 1e-12 * a.output.area());
    ASSERT_EQ(a.domain_vertex.size(), a.domains.size());
    for (std::size_t d = 0; d < a.domains.size(); ++d) {
        const Domain& domain = a.domains[d];
        ASSERT_EQ(static_cast<int>(a.domain_vertex[d].size()), a.output.vertex_count());
        for (int v = 0; v < a.output.vertex_count(); ++v)
            if (a.domain_vertex[d][v] != none) {
                EXPECT_EQ(domain.vertex_parent[a.domain_vertex[d][v]], a.output_parent[v]);
            }
        // Every corner of an output face sees the vertex that the domain's face has there, or the face is not reached at all.
        std::vector<int> domain_face(a.output.face_count(), none);
        for (int f = 0; f < domain.surface.face_count(); ++f) domain_face[domain.face_parent[f]] = f;
        for (int f = 0; f < a.output.face_count(); ++f)
            for (int k = 0; k < 3; ++k)
                EXPECT_EQ(a.domain_vertex[d][a.output.face(f)[k]],
                          domain_face[f] == none ? none : domain.surface.face(domain_face[f])[k]);
        std::vector<int> lefts(domain.surface.vertex_count(), 0);
        for (const Coupling& c : domain.couplings) {
            EXPECT_FALSE(domain.dirichlet[c.left] || domain.dirichlet[c.right]);
            EXPECT_EQ(++lefts[c.left], 1);
        }
        for (const Coupling& c : domain.couplings) EXPECT_EQ(lefts[c.right], 0);
    }
    // A wall's two edges are the same edge of the imprinted surface, each in the face on its side.
    for (const SlitEdge& edge : a.height_slits) {
        for (int i = 0; i < 2; ++i) EXPECT_EQ(a.output_parent[edge.left[i]], a.output_parent[edge.right[i]]);
        EXPECT_NE(edge.left, edge.right);
        const int left = a.output.halfedge_between(edge.left[0], edge.left[1]),
                  right = a.output.halfedge_between(edge.right[1], edge.right[0]);
        ASSERT_TRUE(left != none && right != none);
        EXPECT_EQ(left / 3, edge.left_face);
        EXPECT_EQ(right / 3, edge.right_face);
    }
}

TEST(Slit, WithoutCutsNothingIsRenumbered) {
    const Surface s = fixtures::icosphere(3);
    const SlitSurface cut = slit_surface(s, {});
    EXPECT_EQ(cut.surface.faces(), s.faces());
    EXPECT_EQ(cut.surface.points(), s.points());
}

TEST(Slit, TipStaysWholeAndInteriorDoubles) {
    const Surface s = fixtures::plane(n, n);
    std::vector<char> flags(s.halfedge_count(), 0);
    mark_chain(s, {grid_line(n, 2, 4, 6, 4), {}, false}, flags);
    const SlitSurface cut = slit_surface(s, flags);
    EXPECT_EQ(cut.surface.vertex_count(), s.vertex_count() + 3);
    for (int v = 0; v < s.vertex_count(); ++v) EXPECT_EQ(cut.vertex_parent[v], v);
}

TEST(Slit, CrossingMakesFourCopiesAndKeptFacesComeAlone) {
    const Surface s = fixtures::plane(n, n);
    std::vector<char> flags(s.halfedge_count(), 0);
    mark_chain(s, {grid_line(n, 2, 4, 6, 4), {}, false}, flags);
    mark_chain(s, {grid_line(n, 4, 2, 4, 6), {}, false}, flags);
    const SlitSurface cut = slit_surface(s, flags);
    EXPECT_EQ(std::count(cut.vertex_parent.begin(), cut.vertex_parent.end(), at(4, 4)), 4);

    std::vector<char> keep(s.face_count(), 0);
    keep[0] = keep[5] = 1;
    const SlitSurface two = slit_surface(s, {}, keep);
    EXPECT_EQ(two.face_parent, (std::vector<int>{0, 5}));
    EXPECT_NEAR(two.surface.area(), s.face_area(0) + s.face_area(5), 1e-15);
}

TEST(Region, SmallerSideWhicheverWayAndTieGoesLeft) {
    const Surface s = fixtures::plane(n, n);
    CurveChain small{{at(2, 2), at(3, 2), at(4, 2), at(4, 3), at(4, 4), at(3, 4), at(2, 4), at(2, 3)}, {}, true};
    const auto area = [&](const std::vector<char>& faces) {
        double sum = 0;
        for (int f = 0; f < s.face_count(); ++f) sum += faces[f] * s.face_area(f);
        return sum;
    };
    EXPECT_NEAR(area(faces_inside(s, small)), 1.0 / 16, 1e-14);
    std::reverse(small.vertices.begin(), small.vertices.end());
    EXPECT_NEAR(area(faces_inside(s, small)), 1.0 / 16, 1e-14);

    // The equator of an octahedron-like split: both hemispheres are equal, left of travel wins.
    const Surface torus = fixtures::torus(12, 12);
    CurveChain meridian{{}, {}, true};
    for (int i = 0; i < 12; ++i) meridian.vertices.push_back(i);
    EXPECT_THROW(faces_inside(torus, meridian), Error);
    CurveChain crossing{{at(2, 2), at(3, 2), at(3, 3), at(2, 3), at(2, 2), at(1, 2), at(1, 1), at(2, 1)}, {}, true};
    EXPECT_THROW(faces_inside(s, crossing), Error);
}

TEST(Rows, TwoSidedClosedCurveIsOneOfTwoValues) {
    EdgeScene scene = square();
    std::vector<int> loop = grid_line(n, 2, 2, 6, 2);
    for (int v : grid_line(n, 6, 3, 6, 6)) loop.push_back(v);
    for (int v : grid_line(n, 5, 6, 2, 6)) loop.push_back(v);
    for (int v : grid_line(n, 2, 5, 2, 3)) loop.push_back(v);
    scene.dc(color_side(red), color_side(blue), loop, true);
    const Arrangement a = scene.arrange();
    check_laws(a);
    const Domain& d = a.domains.at(0);
    EXPECT_EQ(d.channels, 4);
    EXPECT_EQ(a.layers[0].height_domain, none);
    EXPECT_EQ(d.surface.vertex_count(), scene.surface().vertex_count() + static_cast<int>(loop.size()));
    const Eigen::MatrixXd u = solve_plainly(d);
    // Counter-clockwise: left is inside. The field is constant on each side, exactly red or blue up to the solver's rounding.
    for (int f = 0; f < d.surface.face_count(); ++f) {
        const Point c = (d.surface.point(d.surface.face(f)[0]) + d.surface.point(d.surface.face(f)[1]) +
                         d.surface.point(d.surface.face(f)[2])) /
                        3;
        const Color expected = c[0] > 0.25 && c[0] < 0.75 && c[1] > 0.25 && c[1] < 0.75 ? red : blue;
        for (int v : d.surface.face(f)) {
            EXPECT_LT((u.row(v).transpose() - expected).norm(), 1e-12);
            if (d.dirichlet[v]) {
                EXPECT_EQ(value_of(d, v), expected);
            }
        }
    }
    EXPECT_TRUE(a.height_slits.empty());
    EXPECT_TRUE(scene.warnings.empty());
}

TEST(Rows, StopsAreConstantBeyondTheEndsOfAnOpenCurve) {
    EdgeScene scene = square();
    SideValues side;
    side.height = {{0.25, 0.75}, {1, 3}};
    scene.dc(side, side, grid_line(n, 2, 4, 6, 4));
    const Arrangement a = scene.arrange();
    check_laws(a);
    const Domain& d = a.domains.at(0);
    const std::array<double, 5> expected{1, 1, 2, 3, 3};
    for (int i = 0; i < 5; ++i)
        for (int v : copies(d, at(2 + i, 4))) EXPECT_DOUBLE_EQ(d.dirichlet_value(v, 0), expected[i]);
}

TEST(Rows, StopsOfAClosedCurveArePeriodicAndTheSeamTakesTheFirst) {
    std::vector<int> loop{at(2, 2), at(4, 2), at(4, 4), at(2, 4)};
    for (const bool jump : {false, true}) {
        EdgeScene scene = square();
        SideValues side;
        if (jump)
            side.height = {{0, 1}, {1, 5}};
        else
            side.height = {{0.25, 0.75}, {1, 3}};
        std::vector<int> chain{at(2, 2), at(3, 2), at(4, 2), at(4, 3), at(4, 4), at(3, 4), at(2, 4), at(2, 3)};
        scene.dc(side, side, chain, true);
        const Arrangement a = scene.arrange();
        const Domain& d = a.domains.at(0);
        // t = 0, 1/8, ... : linear from 3 at -1/4 to 1 at 1/4 and back; with the seam jump from 1 to (almost) 5.
        const std::array<double, 8> periodic{2, 1.5, 1, 1.5, 2, 2.5, 3, 2.5}, seam{1, 1.5, 2, 2.5, 3, 3.5, 4, 4.5};
        for (int i = 0; i < 8; ++i)
            for (int v : copies(d, chain[i])) EXPECT_NEAR(d.dirichlet_value(v, 0), jump ? seam[i] : periodic[i], 1e-14);
    }
}

TEST(Rows, CrossingSectorsTakeTheMeanOfTheirTwoSides) {
    EdgeScene scene = square();
    scene.dc(height_side(1), height_side(2), grid_line(n, 2, 4, 6, 4));    // eastward: left is north
    scene.dc(height_side(10), height_side(20), grid_line(n, 4, 2, 4, 6));  // northward: left is west
    const Arrangement a = scene.arrange();
    check_laws(a);
    const Domain& d = a.domains.at(0);
    ASSERT_EQ(copies(d, at(4, 4)).size(), 4u);
    const auto sector = [&](double x, double y) { return d.dirichlet_value(copy_towards(d, at(4, 4), Point(x, y, 0)), 0); };
    EXPECT_DOUBLE_EQ(sector(0, 1), 5.5);
    EXPECT_DOUBLE_EQ(sector(1, 1), 10.5);
    EXPECT_DOUBLE_EQ(sector(1, 0), 11);
    EXPECT_DOUBLE_EQ(sector(0, 0), 6);
    EXPECT_TRUE(d.feature[copies(d, at(4, 4))[0]]);
    EXPECT_FALSE(d.feature[copies(d, at(3, 4))[0]]);
    EXPECT_TRUE(d.feature[copies(d, at(2, 4))[0]]);
    // Heights differ along both curves: walls, and none at the tips' far side.
    EXPECT_EQ(a.height_slits.size(), 8u);
}

TEST(Rows, ALoneValueWinsOverAnOpenSideAtACrossing) {
    EdgeScene scene = square();
    scene.dc(height_side(1), open_side(), grid_line(n, 2, 4, 6, 4));
    scene.dc(height_side(10), height_side(20), grid_line(n, 4, 2, 4, 6));
    const Arrangement a = scene.arrange();
    check_laws(a);
    const Domain& d = a.domains.at(0);
    const auto sector = [&](double x, double y) { return d.dirichlet_value(copy_towards(d, at(4, 4), Point(x, y, 0)), 0); };
    EXPECT_DOUBLE_EQ(sector(0, 1), 5.5);
    EXPECT_DOUBLE_EQ(sector(1, 0), 20);
    EXPECT_DOUBLE_EQ(sector(0, 0), 10);
    EXPECT_FALSE(d.dirichlet[copy_towards(d, at(5, 4), Point(0.6, 0, 0))]);
    EXPECT_TRUE(d.dirichlet[copy_towards(d, at(5, 4), Point(0.6, 1, 0))]);
}

TEST(Rows, SharedEdgesGoToTheLaterPrimitiveWithAWarning) {
    EdgeScene scene = square();
    scene.dc(height_side(1), height_side(1), grid_line(n, 1, 4, 6, 4));
    scene.dc(height_side(7), height_side(7), grid_line(n, 3, 4, 7, 4));
    const Arrangement a = scene.arrange();
    check_laws(a);
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_NE(scene.warnings[0].find("edges.pvg.json: /layers/0/primitives/1"), std::string::npos);
    const Domain& d = a.domains.at(0);
    for (int v : copies(d, at(4, 4))) EXPECT_EQ(d.dirichlet_value(v, 0), 7);
    for (int v : copies(d, at(2, 4))) EXPECT_EQ(d.dirichlet_value(v, 0), 1);
    for (int v : copies(d, at(3, 4))) EXPECT_EQ(d.dirichlet_value(v, 0), 4);  // between the two: the mean
}

TEST(Rows, AnOpenTipIsOneVertexWithTheMeanOfItsGivenSides) {
    EdgeScene scene = square();
    scene.dc(height_side(1), height_side(4), grid_line(n, 2, 4, 6, 4));
    scene.dc(height_side(1), open_side(), grid_line(n, 2, 6, 6, 6));
    const Arrangement a = scene.arrange();
    check_laws(a);
    const Domain& d = a.domains.at(0);
    ASSERT_EQ(copies(d, at(2, 4)).size(), 1u);
    EXPECT_EQ(d.dirichlet_value(copies(d, at(2, 4))[0], 0), 2.5);
    EXPECT_EQ(d.dirichlet_value(copies(d, at(2, 6))[0], 0), 1);
}

TEST(Rows, ACurveThatEndsOnABorderOrACurveIsSlitToItsEnd) {
    EdgeScene scene = square();
    scene.dc(height_side(1), height_side(4), grid_line(n, 0, 4, 4, 4));
    scene.dc(height_side(2), height_side(2), grid_line(n, 4, 2, 4, 6));
    const Arrangement a = scene.arrange();
    check_laws(a);
    const Domain& d = a.domains.at(0);
    EXPECT_EQ(copies(d, at(0, 4)).size(), 2u);
    EXPECT_EQ(d.dirichlet_value(copy_towards(d, at(0, 4), Point(0, 1, 0)), 0), 1);
    EXPECT_EQ(d.dirichlet_value(copy_towards(d, at(0, 4), Point(0, 0, 0)), 0), 4);
    ASSERT_EQ(copies(d, at(4, 4)).size(), 3u);
    EXPECT_EQ(d.dirichlet_value(copy_towards(d, at(4, 4), Point(0, 1, 0)), 0), 1.5);
    EXPECT_EQ(d.dirichlet_value(copy_towards(d, at(4, 4), Point(0, 0, 0)), 0), 3);
    EXPECT_EQ(d.dirichlet_value(copy_towards(d, at(4, 4), Point(1, 0.5, 0)), 0), 2);
}

TEST(Rows, AlongABorderTheSideOffTheMeshIsIgnored) {
    EdgeScene scene = square();
    scene.dc(height_side(1), height_side(9), grid_line(n, 0, 0, 8, 0));  // eastward along y = 0: left is the mesh
    const Arrangement a = scene.arrange();
    check_laws(a);
    const Domain& d = a.domains.at(0);
    EXPECT_EQ(d.surface.vertex_count(), scene.surface().vertex_count());
    for (int x = 0; x <= n; ++x) EXPECT_EQ(d.dirichlet_value(copies(d, at(x, 0))[0], 0), 1);
    EXPECT_TRUE(a.height_slits.empty());
}

TEST(Rows, ACurveOpenOnBothSidesOfAGroupDoesNotSlitIt) {
    EdgeScene scene = square();
    scene.dc(height_side(1), height_side(2), grid_line(n, 2, 4, 6, 4));
    scene.dc(color_side(red), color_side(blue), grid_line(n, 4, 2, 4, 6));
    const Arrangement a = scene.arrange();
    check_laws(a);
    ASSERT_EQ(a.domains.size(), 2u);
    const Domain& color = a.domains[a.layers[0].color_domain];
    const Domain& height = a.domains[a.layers[0].height_domain];
    EXPECT_EQ(color.channels, 4);
    EXPECT_EQ(height.channels, 1);
    EXPECT_EQ(copies(color, at(3, 4)).size(), 1u);
    EXPECT_EQ(copies(height, at(3, 4)).size(), 2u);
    EXPECT_EQ(copies(height, at(4, 5)).size(), 1u);
    EXPECT_EQ(copies(color, at(4, 5)).size(), 2u);
    EXPECT_EQ(a.output.vertex_count(), scene.surface().vertex_count() + 3 + 3 + 1);  // two slits that cross
    EXPECT_EQ(a.height_slits.size(), 4u);
}

TEST(Rows, ColourAndHeightOfTheSameCurvesShareADomain) {
    EdgeScene scene = square();
    SideValues both = color_side(red);
    both.height = {{0}, {2}};
    scene.dc(both, open_side(), grid_line(n, 2, 4, 6, 4));
    const Arrangement a = scene.arrange();
    check_laws(a);
    ASSERT_EQ(a.domains.size(), 1u);
    EXPECT_EQ(a.domains[0].channels, 5);
    EXPECT_EQ(a.layers[0].color_domain, 0);
    EXPECT_EQ(a.layers[0].height_domain, 0);
    EXPECT_EQ(a.layers[0].height_channel, 4);
    const int v = copy_towards(a.domains[0], at(4, 4), Point(0.5, 1, 0));
    EXPECT_EQ(value_of(a.domains[0], v), red);
    EXPECT_EQ(a.domains[0].dirichlet_value(v, 4), 2);
}

TEST(Rows, LayersAreProblemsOfTheirOwn) {
    EdgeScene scene = square();
    scene.dc(height_side(1), height_side(1), grid_line(n, 2, 4, 6, 4), false, 0);
    scene.dc(height_side(2), height_side(2), grid_line(n, 4, 2, 4, 6), false, 1);
    const Arrangement a = scene.arrange();
    check_laws(a);
    ASSERT_EQ(a.domains.size(), 2u);
    EXPECT_EQ(copies(a.domains[0], at(4, 5)).size(), 1u);
    EXPECT_EQ(copies(a.domains[1], at(3, 4)).size(), 1u);
    EXPECT_NEAR(solve_plainly(a.domains[0]).minCoeff(), 1, 1e-12);
}

TEST(Rows, OnlyWhatACurveReachesIsSolved) {
    EdgeScene scene = square();
    std::vector<int> loop{at(2, 2), at(3, 2), at(4, 2), at(4, 3), at(4, 4), at(3, 4), at(2, 4), at(2, 3)};
    scene.dc(color_side(red), open_side(), loop, true);                  // colour inside only
    scene.dc(height_side(1), height_side(1), grid_line(n, 1, 6, 6, 6));  // height everywhere
    const Arrangement a = scene.arrange();
    check_laws(a);
    const Domain& color = a.domains[a.layers[0].color_domain];
    EXPECT_NEAR(color.surface.area(), 1.0 / 16, 1e-14);
    EXPECT_NEAR(a.domains[a.layers[0].height_domain].surface.area(), 1, 1e-13);
    EXPECT_EQ(a.domain_vertex[a.layers[0].color_domain][at(7, 7)], none);
}

TEST(Rows, ASourceThatNoCurveReachesNamesItsPrimitive) {
    PoissonRegion region;
    region.height = 1;
    {
        EdgeScene scene = square();
        scene.dc(color_side(red), color_side(red), grid_line(n, 1, 1, 5, 1));
        scene.source(scene.add(region, {at(2, 2), at(3, 2), at(3, 3), at(2, 3)}, true), {{0, 1}});
        const std::string message = error_of(scene);
        EXPECT_NE(message.find("edges.pvg.json: /layers/0/primitives/1"), std::string::npos) << message;
        EXPECT_NE(message.find("needs at least one diffusion curve"), std::string::npos) << message;
    }
    {
        // A curve of the group exists, but not on this side of it.
        EdgeScene scene = square();
        scene.dc(open_side(), height_side(1), grid_line(n, 0, 2, 8, 2));
        scene.height_jump({{0, 0.5, 1}, {0, 1, 0}}, grid_line(n, 2, 6, 6, 6));
        EXPECT_NE(error_of(scene).find("/layers/0/primitives/1"), std::string::npos);
    }
}

TEST(Rows, ASharpPoissonCurveJumpsByJ) {
    EdgeScene scene = square();
    scene.dc(height_side(0), height_side(0), grid_line(n, 0, 0, 8, 0));
    scene.height_jump({{0}, {3}}, grid_line(n, 0, 4, 8, 4));  // across the square: left is north
    const Arrangement a = scene.arrange();
    check_laws(a);
    EXPECT_TRUE(scene.warnings.empty());
    const Domain& d = a.domains.at(0);
    EXPECT_EQ(d.couplings.size(), 9u);
    const Eigen::MatrixXd u = solve_plainly(d);
    // The part above is tied to the lower one only by the jump, and is one constant above it.
    for (int f = 0; f < d.surface.face_count(); ++f) {
        const double y = (d.surface.point(d.surface.face(f)[0])[1] + d.surface.point(d.surface.face(f)[1])[1] +
                          d.surface.point(d.surface.face(f)[2])[1]) /
                         3;
        for (int v : d.surface.face(f)) EXPECT_NEAR(u(v, 0), y > 0.5 ? 3 : 0, 1e-12);
    }
    EXPECT_EQ(a.height_slits.size(), 8u);
}

TEST(Rows, JumpsOfCrossingPoissonCurvesAdd) {
    EdgeScene scene = square();
    scene.dc(height_side(0), height_side(0), grid_line(n, 0, 0, 8, 0));
    scene.height_jump({{0}, {3}}, grid_line(n, 0, 4, 8, 4));   // north is 3 above south
    scene.height_jump({{0}, {10}}, grid_line(n, 4, 2, 4, 8));  // west is 10 above east; its lower end is open
    const Arrangement a = scene.arrange();
    check_laws(a);
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_NE(scene.warnings[0].find("does not fade out"), std::string::npos);
    const Domain& d = a.domains.at(0);
    ASSERT_EQ(copies(d, at(4, 4)).size(), 4u);
    EXPECT_EQ(copies(d, at(4, 2)).size(), 1u);
    const Eigen::MatrixXd u = solve_plainly(d);
    const auto sector = [&](double x, double y) { return u(copy_towards(d, at(4, 4), Point(x, y, 0)), 0); };
    EXPECT_NEAR(sector(0, 1) - sector(1, 1), 10, 1e-12);
    EXPECT_NEAR(sector(0, 0) - sector(1, 0), 10, 1e-12);
    EXPECT_NEAR(sector(0, 1) - sector(0, 0), 3, 1e-12);
    EXPECT_NEAR(sector(1, 1) - sector(1, 0), 3, 1e-12);
}

TEST(Rows, OnAPoissonCurveTheDiffusionCurvesValuesWin) {
    EdgeScene scene = square();
    scene.dc(height_side(1), height_side(2), grid_line(n, 2, 4, 6, 4));
    scene.height_jump({{0, 0.5, 1}, {0, 5, 0}}, grid_line(n, 1, 4, 7, 4));
    const Arrangement a = scene.arrange();
    check_laws(a);
    const Domain& d = a.domains.at(0);
    EXPECT_EQ(d.dirichlet_value(copy_towards(d, at(4, 4), Point(0.5, 1, 0)), 0), 1);
    EXPECT_EQ(d.dirichlet_value(copy_towards(d, at(4, 4), Point(0.5, 0, 0)), 0), 2);
    EXPECT_TRUE(d.couplings.empty());
}

TEST(Rows, APoissonCurveThatFadesOutGivesNoWarning) {
    EdgeScene scene = square();
    scene.dc(height_side(0), height_side(0), grid_line(n, 0, 0, 8, 0));
    scene.height_jump({{0, 0.5, 1}, {0, 1, 0}}, grid_line(n, 2, 4, 6, 4));
    const Arrangement a = scene.arrange();
    EXPECT_TRUE(scene.warnings.empty());
    ASSERT_EQ(a.domains.at(0).couplings.size(), 3u);
    const Eigen::MatrixXd u = solve_plainly(a.domains[0]);
    const Domain& d = a.domains[0];
    EXPECT_NEAR(u(copy_towards(d, at(4, 4), Point(0.5, 1, 0)), 0) - u(copy_towards(d, at(4, 4), Point(0.5, 0, 0)), 0), 1, 1e-12);
    EXPECT_NEAR(u(copy_towards(d, at(3, 4), Point(0.3, 1, 0)), 0) - u(copy_towards(d, at(3, 4), Point(0.3, 0, 0)), 0), 0.5,
                1e-12);
}

TEST(Rows, AClosedSharpPoissonCurveReachesItsInside) {
    EdgeScene scene = square();
    scene.dc(height_side(2), height_side(2), grid_line(n, 0, 0, 8, 0));
    scene.height_jump({{0}, {1}}, {at(2, 2), at(3, 2), at(4, 2), at(4, 3), at(4, 4), at(3, 4), at(2, 4), at(2, 3)}, true);
    const Arrangement a = scene.arrange();
    check_laws(a);
    const Domain& d = a.domains.at(0);
    EXPECT_NEAR(d.surface.area(), 1, 1e-13);
    const Eigen::MatrixXd u = solve_plainly(d);
    EXPECT_NEAR(u(copies(d, at(3, 3))[0], 0), 3, 1e-12);
    EXPECT_NEAR(u(copies(d, at(6, 6))[0], 0), 2, 1e-12);
}

TEST(Rows, ColoursAreConvertedBeforeTheyAreInterpolated) {
    EdgeScene scene = square();
    scene.scene.color_space = ColorSpace::srgb;
    SideValues side;
    side.color = {{0, 1}, {Color(0, 0, 0, 1), Color(1, 1, 1, 1)}};
    scene.dc(side, side, grid_line(n, 2, 4, 6, 4));
    const Arrangement a = scene.arrange();
    // Half-way in sRGB is 0.5, not the sRGB value of linear 0.5 (0.735).
    EXPECT_NEAR(a.domains.at(0).dirichlet_value(copies(a.domains[0], at(4, 4))[0], 0), 0.5, 1e-12);
}

TEST(Rows, DisjointSourcesOfOnePrimitiveShareAColumnBetweenColourAndHeight) {
    EdgeScene scene = square();
    SideValues both = color_side(red);
    both.height = {{0}, {2}};
    scene.dc(both, both, grid_line(n, 2, 6, 6, 6));
    PoissonRegion region;
    region.height = 3;
    region.color = Color(1, 2, 3, 0);
    scene.source(scene.add(region, {at(2, 2), at(3, 2), at(3, 3), at(2, 3)}, true), {{0, 1}, {3, -2}});
    const Arrangement a = scene.arrange();
    ASSERT_EQ(a.domains.size(), 1u);
    ASSERT_EQ(a.domains[0].sources.size(), 1u);
    EXPECT_EQ(a.domains[0].sources[0].value, (Eigen::RowVectorXd(5) << 1, 2, 3, 0, 3).finished());
    EXPECT_EQ(a.domains[0].sources[0].profile, (std::vector<std::pair<int, double>>{{0, 1}, {3, -2}}));
}

}  // namespace
}  // namespace pvg::test
