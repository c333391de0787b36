// The same scene gives the same bytes for any number of threads, and the same field on a turned or scaled mesh.
#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "end_to_end/pipeline.h"

namespace pvg::test {
namespace {

json primitives_on_sphere(double radius, const Eigen::Matrix3d& turn) {
    const auto at = [&](double x, double y, double z) {
        const Point p = turn * (Point(x, y, z).normalized() * radius);
        return json{p[0], p[1], p[2]};
    };
    return {{{"kind", "diffusion_curve"},
             {"path", {{"type", "circle"}, {"center", at(0, 0, 1)}, {"radius", 0.25}, {"start", at(1, 0, 1)}}},
             {"left", {{"color", {1, 0.2, 0}}, {"height", 0.02}}},
             {"right", {{"color", {0, 0.3, 1}}, {"height", 0.0}}}},
            {{"kind", "poisson_region"},
             {"path", {{"type", "circle"}, {"center", at(0, 1, -0.3)}, {"radius", 0.12}, {"start", at(1, 1, 0)}}},
             {"rise", {{"height", 0.03}}}},
            {{"kind", "diffusion_curve"},
             {"path", {{"type", "polyline"}, {"points", {at(1, -0.8, -0.5), at(0.2, -1, 0.1), at(-0.7, -0.6, -0.2)}}}},
             {"both", {{"color", {0, 1, 0}}}}}};
}

TEST(Determinism, SameBytesForAnyThreadCount) {
    const ShapeMesh sphere = make_shape("sphere", 4000);
    const json primitives = primitives_on_sphere(sphere.points.at(0).norm(), Eigen::Matrix3d::Identity());
    const Decorated one = decorate(primitives, sphere, {{"length_unit", "bbox"}}, 1);
    for (int threads : {2, 3, 5}) {
        const Decorated many = decorate(primitives, sphere, {{"length_unit", "bbox"}}, threads);
        ASSERT_EQ(one.build.program.fields.size(), many.build.program.fields.size());
        for (std::size_t f = 0; f < one.build.program.fields.size(); ++f) {
            const auto &a = one.build.program.fields[f], &b = many.build.program.fields[f];
            ASSERT_EQ(a.table.indices, b.table.indices);
            ASSERT_EQ(a.table.weights.size(), b.table.weights.size());
            EXPECT_EQ(std::memcmp(a.table.weights.data(), b.table.weights.data(), a.table.weights.size() * sizeof(float)), 0);
            EXPECT_EQ(a.coefficients, b.coefficients);
        }
        EXPECT_EQ(one.evaluation.values, many.evaluation.values);
        EXPECT_EQ(one.evaluation.position, many.evaluation.position);
        EXPECT_EQ(one.evaluation.normal, many.evaluation.normal);
    }
}

TEST(Determinism, FieldTurnsAndScalesWithTheMesh) {
    const ShapeMesh sphere = make_shape("sphere", 4000);
    const double radius = sphere.points.at(0).norm();
    const Decorated plain =
        decorate(primitives_on_sphere(radius, Eigen::Matrix3d::Identity()), sphere, {{"length_unit", "mesh"}});
    // Lengths of the scene are the mesh's own units here, so a scaled mesh is compared through the bounding box's.
    for (double scale : {1.0, 1e-3, 1e3}) {
        const Eigen::Matrix3d turn =
            scale == 1.0 ? Eigen::AngleAxisd(0.7, Point(1, 2, 3).normalized()).toRotationMatrix() : Eigen::Matrix3d::Identity();
        ShapeMesh other = sphere;
        for (Point& p : other.points) p = scale * (turn * p);
        for (Point& n : other.normals) n = turn * n;
        const Decorated reference =
            scale == 1.0 ? decorate(primitives_on_sphere(radius, Eigen::Matrix3d::Identity()), sphere, {{"length_unit", "mesh"}})
                         : decorate(primitives_on_sphere(radius, Eigen::Matrix3d::Identity()), sphere, {{"length_unit", "bbox"}});
        const Decorated moved =
            decorate(primitives_on_sphere(radius * scale, turn), other, {{"length_unit", scale == 1.0 ? "mesh" : "bbox"}});
        // Knots may differ where a tie is broken by rounding; the field is the same to the basis' accuracy.
        double a = 0, b = 0, area_a = 0, area_b = 0;
        const auto areas_a = reference.vertex_areas(), areas_b = moved.vertex_areas();
        for (int v = 0; v < reference.vertex_count(); ++v)
            if (reference.reached(reference.layer().height_domain, v))
                a += areas_a[v] * reference.height(v), area_a += areas_a[v];
        for (int v = 0; v < moved.vertex_count(); ++v)
            if (moved.reached(moved.layer().height_domain, v))
                b += areas_b[v] * moved.height(v), area_b += areas_b[v];
        EXPECT_NEAR(area_b / area_a, scale * scale, 1e-6 * scale * scale);
        EXPECT_NEAR(b / area_b, a / area_a, 2e-3 * std::abs(a / area_a)) << "scale " << scale;
    }
}

}  // namespace
}  // namespace pvg::test
