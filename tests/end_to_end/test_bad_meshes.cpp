// Bad triangulations and odd meshes through the whole pipeline: decorated as well as good ones, or refused by name.
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "cpu_reference/finite_elements.h"
#include "end_to_end/pipeline.h"
#include "fixtures/bad_meshes.h"
#include "fixtures/fem.h"
#include "mesh/border_points.h"
#include "solve/patch_space.h"

namespace pvg::test {
namespace {

constexpr double pi = std::numbers::pi;

json circle_at(const Point& centre, double radius) {
    return {{"type", "circle"}, {"center", {centre[0], centre[1], centre[2]}}, {"radius", radius}};
}

/// A circle with other values on each side, varying along it.
json two_sided(const Point& centre, double radius) {
    const auto stop = [](double t, double h) { return json{{"t", t}, {"color", {0.5 + h, 0.5 - h, t}}, {"height", h}}; };
    return {{"kind", "diffusion_curve"},
            {"path", circle_at(centre, radius)},
            {"left", {stop(0, 0.2), stop(0.5, -0.1)}},
            {"right", {stop(0.2, 0.0), stop(0.7, 0.3)}}};
}

int negative_weights(const Build& build) {
    int count = 0;
    for (const Domain& domain : build.arrangement.domains) {
        const Eigen::SparseMatrix<double> S = surface_stiffness(domain.surface, border_conditions(domain));
        for (int column = 0; column < S.outerSize(); ++column)
            for (Eigen::SparseMatrix<double>::InnerIterator it(S, column); it; ++it)
                count += it.row() < column && it.value() > 1e-8;
    }
    return count;
}

FieldError against_elements(const Decorated& d) {
    FieldError worst;
    for (std::size_t i = 0; i < d.build.arrangement.domains.size(); ++i) {
        const Domain& domain = d.build.arrangement.domains[i];
        const Table& table = d.build.program.fields[i].table;
        Eigen::MatrixXd values(table.row_count, table.channels);
        for (std::uint32_t v = 0; v < table.row_count; ++v)
            for (std::uint32_t c = 0; c < table.channels; ++c)
                values(v, c) = d.evaluation.values[i][std::size_t(table.vertex_row[v]) * table.channels + c];
        const FemProblem problem = fixtures::fem_problem(domain);
        for (const FieldError& e : compare_fields(problem, solve_finite_elements(problem), values)) {
            worst.mean = std::max(worst.mean, e.mean);
            worst.max = std::max(worst.max, e.max);
            worst.h1 = std::max(worst.h1, e.h1);
        }
    }
    return worst;
}

/// x^3 - 3 x y^2 on the rim of a disk of radius 0.4 around the origin in the plane.
Errors harmonic_disk(const ShapeMesh& mesh, int* negative) {
    json stops = json::array();
    for (int i = 0; i <= 256; ++i) stops.push_back({{"t", i / 256.0}, {"height", std::cos(3 * 2 * pi * i / 256.0)}});
    const json rim = {{"kind", "diffusion_curve"}, {"path", circle_at(Point::Zero(), 0.4)}, {"left", stops}};
    const Decorated d = decorate(json::array({rim}), mesh);
    *negative = negative_weights(d.build);
    return height_errors(d, 2, [](const Point& p, int) {
        const double x = p[0] / 0.4, y = p[1] / 0.4;
        return x * x * x - 3 * x * y * y;
    });
}

TEST(BadMeshes, AreAsAccurateAsGoodOnes) {
    const int n = 64;
    struct Case {
        const char* name;
        Surface surface;
    };
    const Surface good =
        fixtures::transformed(fixtures::irregular_plane(n, n), [](const Point& p) { return Point(p.x() - 0.5, p.y() - 0.5, 0); });
    int negative = 0;
    const Errors best = harmonic_disk(fixtures::soup(good), &negative);
    std::printf("%-22s mean %.4f %%, max %.4f %%, %d vertices, %d negative weights\n", "good", best.mean, best.max, best.vertices,
                negative);
    EXPECT_EQ(negative, 0);
    for (const auto& [name, surface] :
         {Case{"slivers, offset 3", fixtures::sheared_square(n, 3)}, Case{"caps, offset 12", fixtures::sheared_square(n, 12)}}) {
        const Errors e = harmonic_disk(fixtures::soup(surface), &negative);
        std::printf("%-22s mean %.4f %%, max %.4f %%, %d vertices, %d negative weights\n", name, e.mean, e.max, e.vertices,
                    negative);
        EXPECT_EQ(negative, 0) << name;
        EXPECT_LE(e.mean, 3 * best.mean) << name;
        EXPECT_LE(e.max, 3 * best.max) << name;
    }
}

TEST(BadMeshes, AreDecorated) {
    struct Case {
        const char* name;
        ShapeMesh mesh;
        Point centre;
        double radius;
    };
    const ShapeMesh square = fixtures::soup(fixtures::transformed(
        fixtures::irregular_plane(24, 24), [](const Point& p) { return Point(p.x() - 0.5, p.y() - 0.5, 0); }));
    std::vector<Case> cases;
    const auto scaled = [](ShapeMesh mesh, double factor) {
        for (Point& p : mesh.points) p *= factor;
        return mesh;
    };
    const Surface torus = fixtures::torus(40, 20);
    cases.push_back({"slivers", fixtures::soup(fixtures::sheared_square(24, 8)), {0.03, 0.02, 0}, 0.2});
    cases.push_back({"needles, edges 1 : 5000", fixtures::soup(fixtures::needle_square(24)), {0.03, 0.02, 0}, 0.2});
    cases.push_back({"scale 1e-6", scaled(square, 1e-6), {0, 0, 0}, 2e-7});
    cases.push_back({"scale 1e6", scaled(square, 1e6), {0, 0, 0}, 2e5});
    cases.push_back({"handle", fixtures::soup(torus), torus.point(7), 0.3});
    cases.push_back({"coarse cuboid", fixtures::soup(fixtures::cuboid()), {0.5, 0.5, 1}, 0.3});
    cases.push_back({"Moebius strip", fixtures::moebius(60, 8), {-1, 0, 0}, 0.12});
    cases.push_back({"fin on a square", fixtures::finned_square(24), {0.02, 0.25, 0}, 0.15});
    ShapeMesh many = square;
    for (int i = 1; i < 6; ++i) fixtures::append(many, square, Point(2.0 * i, 0, 0));
    cases.push_back({"many components", many, {4, 0, 0}, 0.2});
    ShapeMesh touching = square;
    fixtures::append(touching, square, Point(1, 1, 0));
    cases.push_back({"two squares at a corner", touching, {0, 0, 0}, 0.2});
    ShapeMesh duplicate = square;
    duplicate.faces.push_back(square.faces[0]);
    cases.push_back({"a face twice", duplicate, {0.1, 0.1, 0}, 0.2});
    ShapeMesh degenerate = square;
    degenerate.faces.push_back({5, 5, 6});
    degenerate.faces.push_back({0, 1, 2});
    degenerate.points.push_back({77, 0, 0});
    cases.push_back({"no area, unreferenced", degenerate, {0.1, 0.1, 0}, 0.2});
    for (const Case& c : cases) {
        SCOPED_TRACE(c.name);
        try {
            const Decorated d = decorate(json::array({two_sided(c.centre, c.radius)}), c.mesh);
            const FieldError e = against_elements(d);
            const int negative = negative_weights(d.build);
            std::printf("%-26s %6d vertices: mean %.4f %%, max %.4f %%, H1 %.3f %%, %d negative weights\n", c.name,
                        d.vertex_count(), e.mean, e.max, e.h1, negative);
            EXPECT_LE(e.mean, 0.05);
            EXPECT_LE(e.max, 0.39);
            EXPECT_LE(e.h1, 2);
            EXPECT_EQ(negative, 0);
        } catch (const Error& error) {
            ADD_FAILURE() << error.what();
        }
    }
}

TEST(BadMeshes, ACurveOverANonManifoldEdgeIsRefusedByName) {
    // The fin's edges are cut, so a line over them leaves the surface.
    const json line = {{"kind", "diffusion_curve"},
                       {"path", {{"type", "polyline"}, {"points", {{0.1, -0.3, 0}, {0.1, 0.3, 0}}}}},
                       {"both", {{"height", 1.0}}}};
    for (const json& primitive : {line, two_sided({0.02, 0.05, 0}, 0.2)}) try {
            decorate(json::array({primitive}), fixtures::finned_square(24));
            ADD_FAILURE() << "not refused";
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::bad_input);
            EXPECT_NE(std::string(error.what()).find("/layers/0/primitives/0"), std::string::npos) << error.what();
        }
}

TEST(BadMeshes, FieldsDoNotDependOnNumbering) {
    // The same mesh, vertices and faces in another order, rotated and scaled: the field within the accuracy target, the
    // finite-element solution to 1e-5 of the range.
    const Surface ball = fixtures::icosphere(14);
    const Point centre = Point(0.3, 0.5, 0.8).normalized(), start = Point(1, 0.1, 0).normalized();
    const auto primitives = [&](const std::function<Point(const Point&)>& map, double scale) {
        const auto at = [&](const Point& p) {
            const Point q = map(p);
            return json{q[0], q[1], q[2]};
        };
        json curve = two_sided(map(centre), 0.5 * scale);
        curve["path"]["start"] = at(start);
        return json::array({curve});
    };
    const auto same = [](const Point& p) { return p; };
    const Decorated plain = decorate(primitives(same, 1), fixtures::soup(ball));
    const auto height_at = [](const Decorated& d, const Point& p) {
        int best = none;
        double nearest = 1e300;
        for (int v = 0; v < d.vertex_count(); ++v)
            if ((d.base(v) - p).squaredNorm() < nearest) {
                nearest = (d.base(v) - p).squaredNorm();
                best = v;
            }
        return d.height(best);
    };
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.3, Point(2, -1, 1).normalized()).toRotationMatrix();
    struct Case {
        const char* name;
        std::function<Point(const Point&)> map;
        double scale;
        bool shuffle;
    };
    for (const Case& c :
         {Case{"numbering", same, 1, true}, Case{"rotation", [&](const Point& p) -> Point { return turn * p; }, 1, false},
          Case{"scale", [](const Point& p) -> Point { return 300 * p; }, 300, false}}) {
        Surface surface = fixtures::transformed(ball, c.map);
        if (c.shuffle)
            surface = fixtures::permuted(surface, 12).surface;
        const Decorated other = decorate(primitives(c.map, c.scale), fixtures::soup(surface));
        double worst = 0;
        for (int v = 0; v < ball.vertex_count(); v += 3) {
            const Point& p = ball.point(v);
            if (std::abs(std::acos(p.dot(centre)) - 0.5) > 0.02)  // the same side of the curve, beyond doubt
                worst = std::max(worst, std::abs(height_at(plain, p) - height_at(other, c.map(p))) / 0.4);
        }
        std::printf("%-10s field moves by %.4f %% of the range\n", c.name, 100 * worst);
        EXPECT_LE(worst, 0.0039) << c.name;
    }
}

}  // namespace
}  // namespace pvg::test
