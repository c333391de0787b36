// Scenes drawn along mesh edges by hand: chains instead of paths, so that groups and slits are tested without tracing.
// And a plain finite-element solver for what comes out, which shares no code with the program's own.
#pragma once

#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include "curves/drawing.h"
#include "fixtures/meshes.h"

namespace pvg::test {

inline SideValues color_side(const Color& color) { return {{{0}, {color}}, {}}; }
inline SideValues height_side(double height) { return {{}, {{0}, {height}}}; }
inline SideValues open_side() { return {}; }

inline const Color red{1, 0, 0, 1}, blue{0, 0, 1, 1}, green{0, 1, 0, 1}, white{1, 1, 1, 1};

/// Primitives along mesh edges; t by arc length.
class EdgeScene {
public:
    explicit EdgeScene(Surface surface) : surface_(std::move(surface)) { scene.file = "edges.pvg.json"; }

    int add(std::variant<DiffusionCurve, PoissonCurve, PoissonRegion> shape, std::vector<int> vertices, bool closed = false,
            int layer = 0) {
        while (static_cast<int>(scene.layers.size()) <= layer) scene.layers.emplace_back();
        Primitive primitive;
        primitive.pointer =
            "/layers/" + std::to_string(layer) + "/primitives/" + std::to_string(scene.layers[layer].primitives.size());
        primitive.shape = std::move(shape);
        scene.layers[layer].primitives.push_back(std::move(primitive));
        CurveChain chain;
        chain.closed = closed;
        double total = 0;
        for (std::size_t i = 0; i < vertices.size(); ++i) {
            if (i > 0)
                total += (surface_.point(vertices[i]) - surface_.point(vertices[i - 1])).norm();
            chain.t.push_back(total);
        }
        if (closed)
            total += (surface_.point(vertices.front()) - surface_.point(vertices.back())).norm();
        for (double& t : chain.t) t /= total;
        chain.vertices = std::move(vertices);
        chains_.push_back({layer, scene.layers[layer].primitives.size() - 1, std::move(chain), {}});
        return static_cast<int>(chains_.size()) - 1;
    }
    int dc(SideValues left, SideValues right, std::vector<int> vertices, bool closed = false, int layer = 0) {
        return add(DiffusionCurve{{}, std::move(left), std::move(right)}, std::move(vertices), closed, layer);
    }
    int height_jump(Stops<double> jump, std::vector<int> vertices, bool closed = false, int layer = 0) {
        PoissonCurve curve;
        curve.height_jump = std::move(jump);
        return add(curve, std::move(vertices), closed, layer);
    }
    void source(int primitive, std::vector<std::pair<int, double>> profile) {
        chains_[primitive].sources = {{std::move(profile), {}, 0}};
    }

    Arrangement arrange() {
        Drawing drawing{{surface_, identity_map(surface_)}, {}};
        for (const Chain& c : chains_) {
            const Primitive& primitive = scene.layers[c.layer].primitives[c.index];
            drawing.primitives.push_back(
                {&primitive, c.layer, scene.file.string() + ": " + primitive.pointer, c.chain, {}, c.sources});
        }
        warnings.clear();
        return arrange_drawing(scene, surface_, std::move(drawing), warnings);
    }

    const Surface& surface() const { return surface_; }
    Scene scene;
    Warnings warnings;

private:
    struct Chain {
        int layer;
        std::size_t index;
        CurveChain chain;
        std::vector<DrawnSource> sources;
    };
    Surface surface_;
    std::vector<Chain> chains_;
};

/// Copies in the domain of a vertex of the imprinted surface.
inline std::vector<int> copies(const Domain& domain, int parent) {
    std::vector<int> found;
    for (int v = 0; v < domain.surface.vertex_count(); ++v)
        if (domain.vertex_parent[v] == parent)
            found.push_back(v);
    return found;
}

/// The copy of a vertex on the side of the point.
inline int copy_towards(const Domain& domain, int parent, const Point& towards) {
    int best = none;
    double least = 0;
    for (int v : copies(domain, parent)) {
        for (int h = 0; h < domain.surface.halfedge_count(); ++h) {
            if (domain.surface.origin(h) != v)
                continue;
            const auto& [a, b, c] = domain.surface.face(h / 3);
            const double d = ((domain.surface.point(a) + domain.surface.point(b) + domain.surface.point(c)) / 3 - towards).norm();
            if (best == none || d < least) {
                best = v;
                least = d;
            }
        }
    }
    return best;
}

/// The edge chain through the vertices nearest to given points of a plane grid made by fixtures::plane(nx, ny).
inline std::vector<int> grid_line(int nx, int x0, int y0, int x1, int y1) {
    std::vector<int> line;
    const int steps = std::max(std::abs(x1 - x0), std::abs(y1 - y0));
    for (int i = 0; i <= steps; ++i) line.push_back((y0 + (y1 - y0) * i / steps) * (nx + 1) + x0 + (x1 - x0) * i / steps);
    return line;
}

/// Linear elements with cotangents from positions, all channels. Vertices that nothing reaches stay 0.
inline Eigen::MatrixXd solve_plainly(const Domain& domain) {
    const Surface& s = domain.surface;
    const int count = s.vertex_count();
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::MatrixXd load = Eigen::MatrixXd::Zero(count, domain.channels);
    for (int h = 0; h < s.halfedge_count(); ++h) {
        const Point p = s.point(s.origin(h)) - s.point(s.origin(Surface::prev(h))),
                    q = s.point(s.target(h)) - s.point(s.origin(Surface::prev(h)));
        const double w = 0.5 * p.dot(q) / p.cross(q).norm();
        const int a = s.origin(h), b = s.target(h);
        entries.emplace_back(a, a, w);
        entries.emplace_back(b, b, w);
        entries.emplace_back(a, b, -w);
        entries.emplace_back(b, a, -w);
    }
    for (const SourceColumn& column : domain.sources)
        for (const auto& [f, value] : column.profile)
            for (int v : s.face(f)) load.row(v) += value * s.face_area(f) / 3 * column.value;
    Eigen::SparseMatrix<double> stiffness(count, count);
    stiffness.setFromTriplets(entries.begin(), entries.end());
    // u = P x + g: fixed values and jumps in g.
    Eigen::MatrixXd g = Eigen::MatrixXd::Zero(count, domain.channels);
    std::vector<int> stands_for(count);
    for (int v = 0; v < count; ++v) stands_for[v] = v;
    for (const Coupling& c : domain.couplings) {
        stands_for[c.left] = c.right;
        g.row(c.left) = c.jump;
    }
    std::vector<int> unknown(count, none);
    int unknowns = 0;
    for (int v = 0; v < count; ++v) {
        if (domain.dirichlet[v])
            g.row(v) = domain.dirichlet_value.row(v);
        else if (stands_for[v] == v)
            unknown[v] = unknowns++;
    }
    std::vector<Eigen::Triplet<double>> selection;
    for (int v = 0; v < count; ++v)
        if (!domain.dirichlet[v])
            selection.emplace_back(v, unknown[stands_for[v]], 1.0);
    Eigen::SparseMatrix<double> P(count, unknowns);
    P.setFromTriplets(selection.begin(), selection.end());
    const Eigen::SparseMatrix<double> reduced = P.transpose() * stiffness * P;
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(reduced);
    const Eigen::MatrixXd x = factor.solve(P.transpose() * (-load - stiffness * g));
    return P * x + g;
}

}  // namespace pvg::test
