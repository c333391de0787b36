// Numbering, rotation and scale change nothing: lambda and field with the same knots, the finite-element solution always.
#include <algorithm>
#include <cstdio>
#include <string>

#include <gtest/gtest.h>

#include "fixtures/fem.h"
#include "solve/bad_domains.h"
#include "solve/basis.h"
#include "solve/galerkin.h"
#include "solve/system.h"

namespace pvg {
namespace {

/// vertex[v], face[f]: new numbers.
struct Renumbered {
    Domain domain;
    std::vector<int> vertex;
};

Renumbered renumbered(const Domain& domain, bool faces_only) {
    fixtures::Random random(21);
    const int vertices = domain.surface.vertex_count(), faces = domain.surface.face_count();
    const auto shuffled = [&](int count, bool shuffle) {
        std::vector<int> to(count);
        for (int i = 0; i < count; ++i) to[i] = i;
        for (int i = count - 1; i > 0 && shuffle; --i) std::swap(to[i], to[random.below(i + 1)]);
        return to;
    };
    Renumbered result{domain, shuffled(vertices, !faces_only)};
    const std::vector<int>& vertex = result.vertex;
    const std::vector<int> face = shuffled(faces, true);
    std::vector<Point> points(vertices);
    std::vector<Face> triangles(faces);
    Domain& d = result.domain;
    for (int v = 0; v < vertices; ++v) {
        const int to = vertex[v];
        points[to] = domain.surface.point(v);
        d.vertex_parent[to] = domain.vertex_parent[v];
        d.dirichlet[to] = domain.dirichlet[v];
        d.dirichlet_value.row(to) = domain.dirichlet_value.row(v);
        d.on_curve[to] = domain.on_curve[v];
        d.feature[to] = domain.feature[v];
        d.edge_length[to] = domain.edge_length[v];
    }
    for (int f = 0; f < faces; ++f) {
        const Face& old = domain.surface.face(f);
        const int turn = random.below(3);
        for (int k = 0; k < 3; ++k) triangles[face[f]][k] = vertex[old[(k + turn) % 3]];
        d.face_parent[face[f]] = domain.face_parent[f];
    }
    d.surface = Surface(points, triangles);
    for (Coupling& c : d.couplings) {
        c.left = vertex[c.left];
        c.right = vertex[c.right];
    }
    for (SourceColumn& source : d.sources) {
        for (auto& part : source.profile) part.first = face[part.first];
        std::sort(source.profile.begin(), source.profile.end());
    }
    return result;
}

struct Solution {
    Eigen::VectorXd lambda, field, elements;  // by vertex; lambda 0 where there is no knot
    double range = 0;
};

Solution solve(const Domain& domain, const Knots& knots) {
    const Voronoi voronoi = geodesic_voronoi(domain, knots);
    const System system(domain, knots, voronoi);
    const PatchSpace space(domain, knots, voronoi);
    const Table table = local_basis(space, {.threads = 2});
    Eigen::MatrixXd lambda = system.solve(domain);
    minimise_energy(space, table, system, {}, lambda);
    Solution s;
    s.lambda = Eigen::VectorXd::Zero(domain.surface.vertex_count());
    for (std::size_t j = 0; j < knots.vertex.size(); ++j) s.lambda[knots.vertex[j]] = lambda(static_cast<Eigen::Index>(j), 0);
    Eigen::VectorXd all(table.coefficient_count);
    all.head(lambda.rows()) = lambda.col(0);
    for (std::size_t i = 0; i < domain.sources.size(); ++i)
        all[lambda.rows() + static_cast<Eigen::Index>(i)] = domain.sources[i].value[0];
    s.field = fixtures::evaluate(table, all);
    s.elements = solve_finite_elements(fixtures::fem_problem(domain)).col(0);
    s.range = s.elements.maxCoeff() - s.elements.minCoeff();
    return s;
}

double apart(const Eigen::VectorXd& a, const Eigen::VectorXd& b, const std::vector<int>& vertex) {
    double worst = 0;
    for (Eigen::Index v = 0; v < a.size(); ++v) worst = std::max(worst, std::abs(a[v] - b[vertex[static_cast<std::size_t>(v)]]));
    return worst;
}

TEST(Invariance, NumberingRotationAndScale) {
    for (const auto& [name, domain] : fixtures::bad_domains()) {
        const Knots knots = place_knots(domain, {.spacing = 0.03 * domain.surface.diagonal()});
        const Solution plain = solve(domain, knots);
        const double error = (plain.field - plain.elements).cwiseAbs().maxCoeff() / plain.range;
        std::printf("%-36s %.4f %% of the range from the finite elements\n", name, 100 * error);
        EXPECT_LE(error, 0.0039) << name;
        for (const char* change : {"vertices", "faces", "rotation", "scale"}) {
            Renumbered other = renumbered(domain, change[0] == 'f');
            if (change[0] == 'r' || change[0] == 's') {
                other = {domain, other.vertex};
                for (std::size_t v = 0; v < other.vertex.size(); ++v) other.vertex[v] = static_cast<int>(v);
                const double factor = change[0] == 's' ? 1e3 : 1;
                other.domain.surface =
                    change[0] == 's' ? fixtures::scaled(domain.surface, factor) : fixtures::rotated(domain.surface, 0.9);
                for (double& length : other.domain.edge_length) length *= factor;
                for (SourceColumn& source : other.domain.sources) source.value /= factor * factor;
            }
            Knots same;
            for (int v : knots.vertex) same.vertex.push_back(other.vertex[v]);
            std::sort(same.vertex.begin(), same.vertex.end());
            same.knot_of_vertex.assign(other.vertex.size(), none);
            for (std::size_t j = 0; j < same.vertex.size(); ++j) same.knot_of_vertex[same.vertex[j]] = static_cast<int>(j);
            const Solution moved = solve(other.domain, same);
            const double lambda = apart(plain.lambda, moved.lambda, other.vertex) / plain.range;
            const double field = apart(plain.field, moved.field, other.vertex) / plain.range;
            const double elements = apart(plain.elements, moved.elements, other.vertex) / plain.range;
            std::printf("%-36s %-9s lambda %.1e, field %.1e, finite elements %.1e of the range\n", name, change, lambda, field,
                        elements);
            EXPECT_LE(lambda, 1e-5) << name << ", " << change;
            EXPECT_LE(field, 1e-5) << name << ", " << change;
            EXPECT_LE(elements, 1e-5) << name << ", " << change;
        }
    }
}

}  // namespace
}  // namespace pvg
