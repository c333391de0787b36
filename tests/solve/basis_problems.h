// Poisson problems on meshes made in code, their finite-element solutions and the errors of a table against them.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include <Eigen/SparseCholesky>

#include "fixtures/domains.h"
#include "mesh/intrinsic.h"
#include "pvg/table.h"

namespace pvg::fixtures {

/// A chain of vertices to slit along, with the value that each side fixes (open: natural on that side; jump: a sharp Poisson
/// curve, left - right).
struct Chain {
    std::vector<int> vertices;
    std::function<double(const Point&)> left, right, jump;
};

/// Slits the surface along the chains. Copies of a vertex take the mean of the values that their sides' edges give.
inline Domain slit_domain(const Surface& unslit, const std::vector<Chain>& chains) {
    const int halfedges = unslit.halfedge_count();
    std::vector<int> chain_of(halfedges, none);  // halfedge on the left of travel: chain
    for (std::size_t c = 0; c < chains.size(); ++c)
        for (std::size_t i = 0; i + 1 < chains[c].vertices.size(); ++i) {
            const int h = unslit.halfedge_between(chains[c].vertices[i], chains[c].vertices[i + 1]);
            const int g = unslit.halfedge_between(chains[c].vertices[i + 1], chains[c].vertices[i]);
            if (h != none)
                chain_of[h] = static_cast<int>(c);
            if (g != none)
                chain_of[g] = static_cast<int>(c) + 1000;
        }
    // Corners of one vertex that faces join without crossing a chain are one copy.
    std::vector<int> copy(halfedges, none);
    std::vector<int> parent;
    for (int corner = 0; corner < halfedges; ++corner) {
        if (copy[corner] != none)
            continue;
        std::vector<int> stack{corner};
        copy[corner] = static_cast<int>(parent.size());
        while (!stack.empty()) {
            const int h = stack.back();
            stack.pop_back();
            for (const auto& [edge, forward] : {std::pair{h, false}, std::pair{Surface::prev(h), true}}) {
                const int t = unslit.twin(edge);
                if (t == none || chain_of[edge] != none || chain_of[t] != none)
                    continue;
                const int other = forward ? t : Surface::next(t);
                if (copy[other] != none)
                    continue;
                copy[other] = copy[corner];
                stack.push_back(other);
            }
        }
        parent.push_back(unslit.origin(corner));
    }
    std::vector<Point> points;
    for (int p : parent) points.push_back(unslit.point(p));
    std::vector<Face> faces;
    for (int f = 0; f < unslit.face_count(); ++f) faces.push_back({copy[3 * f], copy[3 * f + 1], copy[3 * f + 2]});

    Domain domain;
    domain.surface = Surface(points, faces);
    domain.vertex_parent = parent;
    for (int f = 0; f < unslit.face_count(); ++f) domain.face_parent.push_back(f);
    const int vertices = domain.surface.vertex_count();
    domain.channels = 1;
    domain.dirichlet.assign(vertices, 0);
    domain.dirichlet_value = Eigen::MatrixXd::Zero(vertices, 1);
    domain.on_curve.assign(vertices, 0);
    domain.feature.assign(vertices, 0);
    std::vector<double> sum(vertices, 0);
    std::vector<int> given(vertices, 0), left_copy(unslit.vertex_count(), none), right_copy(unslit.vertex_count(), none);
    for (int h = 0; h < halfedges; ++h) {
        if (chain_of[h] == none)
            continue;
        const bool left = chain_of[h] < 1000;
        const Chain& chain = chains[chain_of[h] % 1000];
        for (int corner : {h, Surface::next(h)}) {
            const int v = copy[corner];
            domain.on_curve[v] = 1;
            const auto& value = left ? chain.left : chain.right;
            if (value) {
                sum[v] += value(points[v]);
                ++given[v];
            }
            if (chain.jump)
                (left ? left_copy : right_copy)[parent[v]] = v;
        }
    }
    for (int v = 0; v < vertices; ++v)
        if (given[v]) {
            domain.dirichlet[v] = 1;
            domain.dirichlet_value(v, 0) = sum[v] / given[v];
        }
    for (int p = 0; p < unslit.vertex_count(); ++p)
        if (left_copy[p] != none && right_copy[p] != none && left_copy[p] != right_copy[p] && !domain.dirichlet[left_copy[p]] &&
            !domain.dirichlet[right_copy[p]])
            for (const Chain& chain : chains)
                if (chain.jump && std::count(chain.vertices.begin(), chain.vertices.end(), p) &&
                    (domain.couplings.empty() || domain.couplings.back().left != left_copy[p]))
                    domain.couplings.push_back(
                        {left_copy[p], right_copy[p], Eigen::RowVectorXd::Constant(1, chain.jump(unslit.point(p)))});
    for (const Chain& chain : chains)
        for (int end : {chain.vertices.front(), chain.vertices.back()})
            for (int v = 0; v < vertices; ++v)
                if (parent[v] == end && (chain.left || chain.right))
                    domain.feature[v] = 1;
    measure_edges(domain);
    return domain;
}

/// A source over the faces whose centroid is nearer than `inner` to the centre, balanced by a ring up to `outer` (none where
/// outer <= inner).
inline void add_disc_source(Domain& domain, const Point& centre, double inner, double outer, double value) {
    std::vector<int> kind(domain.surface.face_count(), 0);
    double inside = 0, ring = 0;
    for (int f = 0; f < domain.surface.face_count(); ++f) {
        Point middle = Point::Zero();
        for (int v : domain.surface.face(f)) middle += domain.surface.point(v) / 3;
        const double r = (middle - centre).norm();
        kind[f] = r < inner ? 1 : r < outer ? 2 : 0;
        if (kind[f] == 1)
            inside += domain.surface.face_area(f);
        if (kind[f] == 2)
            ring += domain.surface.face_area(f);
    }
    SourceColumn column;
    column.primitive = "disc";
    column.value = Eigen::RowVectorXd::Constant(1, value);
    for (int f = 0; f < domain.surface.face_count(); ++f)
        if (kind[f])
            column.profile.emplace_back(f, kind[f] == 1 ? 1.0 : -inside / ring);
    domain.sources.push_back(column);
    for (int h = 0; h < domain.surface.halfedge_count(); ++h) {
        const int t = domain.surface.twin(h);
        if (t != none && kind[h / 3] != kind[t / 3])
            domain.on_curve[domain.surface.origin(h)] = domain.on_curve[domain.surface.target(h)] = 1;
    }
}

/// Extrinsic cotan stiffness, assembled from positions, independently of the library's.
inline Eigen::SparseMatrix<double> fem_stiffness(const Surface& surface) {
    std::vector<Eigen::Triplet<double>> entries;
    for (int h = 0; h < surface.halfedge_count(); ++h) {
        const int i = surface.origin(h), j = surface.target(h), k = surface.origin(Surface::prev(h));
        const Point a = surface.point(i) - surface.point(k), b = surface.point(j) - surface.point(k);
        const double w = 0.5 * a.dot(b) / a.cross(b).norm();
        entries.insert(entries.end(), {{i, j, -w}, {j, i, -w}, {i, i, w}, {j, j, w}});
    }
    Eigen::SparseMatrix<double> S(surface.vertex_count(), surface.vertex_count());
    S.setFromTriplets(entries.begin(), entries.end());
    return S;
}

/// The linear finite-element solution of a domain with a given stiffness.
inline Eigen::VectorXd fem_solution(const Domain& domain, const Eigen::SparseMatrix<double>& S) {
    const int n = domain.surface.vertex_count();
    std::vector<int> unknown(n, none);
    Eigen::VectorXd offset = domain.dirichlet_value.col(0);
    for (int v = 0; v < n; ++v) unknown[v] = domain.dirichlet[v] ? none : 0;
    for (const Coupling& c : domain.couplings) unknown[c.left] = none;
    int count = 0;
    for (int v = 0; v < n; ++v)
        if (unknown[v] != none)
            unknown[v] = count++;
    for (const Coupling& c : domain.couplings) {
        unknown[c.left] = unknown[c.right];
        offset[c.left] = c.jump[0];
    }
    Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
    for (const SourceColumn& source : domain.sources)
        for (const auto& [face, laplacian] : source.profile)
            for (int v : domain.surface.face(face))
                if (unknown[v] != none)
                    right[unknown[v]] -= laplacian * source.value[0] * domain.surface.face_area(face) / 3;
    std::vector<Eigen::Triplet<double>> entries;
    for (int column = 0; column < n; ++column)
        for (Eigen::SparseMatrix<double>::InnerIterator e(S, column); e; ++e) {
            const int row = unknown[e.row()];
            if (row == none)
                continue;
            right[row] -= e.value() * offset[column];
            if (unknown[column] != none)
                entries.emplace_back(row, unknown[column], e.value());
        }
    Eigen::SparseMatrix<double> inner(count, count);
    inner.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(inner);
    const Eigen::VectorXd x = factor.solve(right);
    Eigen::VectorXd u(n);
    for (int v = 0; v < n; ++v) u[v] = offset[v] + (unknown[v] != none ? x[unknown[v]] : 0);
    return u;
}

struct TableError {
    double mean = 0, max = 0, h1 = 0;  ///< % of the truth's range; h1: relative energy norm, %
    int worst = none;                  ///< vertex of the largest error
};

inline TableError compare(const Domain& domain, const Eigen::SparseMatrix<double>& S, const Eigen::VectorXd& truth,
                          const Eigen::VectorXd& values) {
    const Eigen::VectorXd error = values - truth;
    const double range = truth.maxCoeff() - truth.minCoeff();
    Eigen::VectorXd area = Eigen::VectorXd::Zero(truth.size());
    for (int f = 0; f < domain.surface.face_count(); ++f)
        for (int v : domain.surface.face(f)) area[v] += domain.surface.face_area(f) / 3;
    TableError result;
    result.mean = 100 * area.dot(error.cwiseAbs()) / area.sum() / range;
    Eigen::Index worst;
    result.max = 100 * error.cwiseAbs().maxCoeff(&worst) / range;
    result.worst = static_cast<int>(worst);
    result.h1 = 100 * std::sqrt(error.dot(S * error) / truth.dot(S * truth));
    return result;
}

/// One channel, in double arithmetic on the table's float weights.
inline Eigen::VectorXd evaluate(const Table& table, const Eigen::VectorXd& coefficients) {
    Eigen::VectorXd u = Eigen::VectorXd::Zero(table.row_count);
    for (std::uint32_t c = 0; c < table.cell_count; ++c) {
        const std::uint32_t stride = table.cell_first_index[c + 1] - table.cell_first_index[c];
        for (std::uint32_t row = table.cell_first_row[c]; row < table.cell_first_row[c + 1]; ++row)
            for (std::uint32_t e = 0; e < stride; ++e)
                u[table.row_vertex[row]] +=
                    static_cast<double>(
                        table.weights[table.cell_first_weight[c] + (row - table.cell_first_row[c]) * stride + e]) *
                    coefficients[table.indices[table.cell_first_index[c] + e]];
    }
    return u;
}

/// Stored pairs a vertex, padding and sources included, over the vertices that no curve fixes.
inline double entries_per_vertex(const Domain& domain, const Table& table) {
    double entries = 0, rows = 0;
    for (std::uint32_t c = 0; c < table.cell_count; ++c)
        for (std::uint32_t row = table.cell_first_row[c]; row < table.cell_first_row[c + 1]; ++row) {
            if (domain.dirichlet[table.row_vertex[row]])
                continue;
            entries += table.cell_first_index[c + 1] - table.cell_first_index[c];
            rows += 1;
        }
    return entries / rows;
}

/// Smooth bend of the unit square.
inline Point bend(const Point& p) {
    return {p.x() + 0.04 * std::sin(2 * std::numbers::pi * p.y()) * p.x() * (1 - p.x()) * 4,
            p.y() + 0.05 * std::sin(std::numbers::pi * p.x()) * std::sin(2 * std::numbers::pi * p.y()), 0};
}

/// n x n irregular bent unit square, slit along chains of its grid lines.
class BentSquare {
public:
    explicit BentSquare(int n) : n_(n) {}
    int at(double x, double y) const {
        return static_cast<int>(std::lround(y * n_)) * (n_ + 1) + static_cast<int>(std::lround(x * n_));
    }
    /// A chain along grid lines through the given corners (fractions of the square).
    std::vector<int> line(const std::vector<std::pair<double, double>>& corners) const {
        std::vector<int> chain{at(corners[0].first, corners[0].second)};
        for (std::size_t k = 1; k < corners.size(); ++k) {
            const int to = at(corners[k].first, corners[k].second);
            while (chain.back() != to) {
                const int dx = to % (n_ + 1) - chain.back() % (n_ + 1), dy = to / (n_ + 1) - chain.back() / (n_ + 1);
                chain.push_back(chain.back() + (dx > 0) - (dx < 0) + (dx == 0) * (n_ + 1) * ((dy > 0) - (dy < 0)));
            }
        }
        return chain;
    }
    /// delaunay: edges that are not slit are flipped; else diagonals are random.
    Domain domain(const std::vector<Chain>& chains, bool delaunay = true) const {
        Random random(5);
        std::vector<char> on_line((n_ + 1) * (n_ + 1), 0);
        for (const Chain& chain : chains)
            for (int v : chain.vertices) on_line[v] = 1;
        std::vector<Point> points;
        for (int y = 0; y <= n_; ++y)
            for (int x = 0; x <= n_; ++x) {
                const bool inside = x > 0 && y > 0 && x < n_ && y < n_ && !on_line[y * (n_ + 1) + x];
                const double jx = random.real(-0.24, 0.24), jy = random.real(-0.24, 0.24);
                points.push_back(bend({(x + inside * jx) / n_, (y + inside * jy) / n_, 0}));
            }
        std::vector<Face> faces;
        for (int y = 0; y < n_; ++y)
            for (int x = 0; x < n_; ++x) {
                const int a = y * (n_ + 1) + x, b = a + 1, c = b + n_ + 1, d = c - 1;
                if (random.below(2)) {
                    faces.push_back({a, b, c});
                    faces.push_back({a, c, d});
                } else {
                    faces.push_back({a, b, d});
                    faces.push_back({b, c, d});
                }
            }
        Domain domain = slit_domain(Surface(points, faces), chains);
        if (!delaunay)
            return domain;
        // In the plane the flipped triangles are ordinary ones.
        IntrinsicTriangulation triangulation = intrinsic_triangulation(domain.surface);
        make_delaunay(triangulation);
        domain.surface = Surface(domain.surface.points(), triangulation.faces);
        return domain;
    }

private:
    int n_;
};

/// Three slit diffusion curves with varying values, a balanced disc source, an open border.
inline Domain three_curves(int n, bool with_source = true, bool delaunay = true) {
    const BentSquare square(n);
    std::vector<Chain> chains(3);
    chains[0].vertices = square.line({{0.15, 0.3}, {0.55, 0.3}});
    chains[1].vertices = square.line({{0.7, 0.2}, {0.7, 0.8}});
    chains[2].vertices = square.line({{0.25, 0.75}, {0.6, 0.75}});
    chains[0].left = [](const Point& p) { return 1 - 0.5 * p.x(); };
    chains[0].right = [](const Point& p) { return -0.4 + 0.3 * p.x(); };
    chains[1].left = [](const Point&) { return 0.2; };
    chains[1].right = [](const Point& p) { return 0.8 - p.y(); };
    chains[2].left = [](const Point&) { return -0.6; };
    chains[2].right = [](const Point& p) { return 0.5 * std::cos(7 * p.x()); };
    Domain domain = square.domain(chains, delaunay);
    if (with_source)
        add_disc_source(domain, {0.33, 0.52, 0}, 0.08, 0.11, -120);
    return domain;
}

/// Two diffusion curves that cross, one closed with an open outside, a sharp Poisson curve that fades out at its ends, two narrow
/// channels.
inline Domain crossings_and_jump(int n) {
    const BentSquare square(n);
    std::vector<Chain> chains(6);
    chains[0].vertices = square.line({{0.1, 0.3}, {0.5, 0.3}});
    chains[1].vertices = square.line({{0.3, 0.1}, {0.3, 0.5}});
    chains[2].vertices = square.line({{0.6, 0.2}, {0.8, 0.2}, {0.8, 0.4}, {0.6, 0.4}, {0.6, 0.2}});
    chains[3].vertices = square.line({{0.2, 0.7}, {0.6, 0.7}});
    chains[4].vertices = square.line({{0.7, 0.6}, {0.95, 0.6}});
    chains[5].vertices = square.line({{0.7, 0.625}, {0.95, 0.625}});
    chains[0].left = [](const Point& p) { return 1 - p.x(); };
    chains[0].right = [](const Point&) { return -0.4; };
    chains[1].left = [](const Point&) { return 0.2; };
    chains[1].right = [](const Point& p) { return 0.8 - p.y(); };
    chains[2].left = [](const Point& p) { return p.y() + p.x(); };
    chains[3].jump = [](const Point& p) { return 2 * std::max(0.0, 1 - std::pow((p.x() - 0.37) / 0.19, 2)); };  // 0 at both ends
    chains[4].left = chains[4].right = [](const Point& p) { return std::sin(9 * p.x()); };
    chains[5].left = [](const Point&) { return 0.7; };
    chains[5].right = [](const Point& p) { return 0.7 - p.x(); };
    Domain domain = square.domain(chains);
    const Point crossing = bend({0.3, 0.3, 0});
    for (int v = 0; v < domain.surface.vertex_count(); ++v)
        if ((domain.surface.point(v) - crossing).norm() < 1e-9)
            domain.feature[v] = 1;
    return domain;
}

/// The shortest chain of edges between the vertices nearest to two points.
inline std::vector<int> edge_path(const Surface& surface, const Point& from, const Point& to) {
    const int start = nearest_vertex(surface, from), end = nearest_vertex(surface, to);
    std::vector<double> distance(surface.vertex_count(), 1e300);
    std::vector<int> before(surface.vertex_count(), none);
    std::set<std::pair<double, int>> queue{{0, start}};
    distance[start] = 0;
    while (!queue.empty()) {
        const int v = queue.begin()->second;
        queue.erase(queue.begin());
        int h = surface.outgoing(v);
        do {  // closed surfaces only
            const int w = surface.target(h);
            if (const double d = distance[v] + surface.length(h); d < distance[w] - 1e-12) {
                queue.erase({distance[w], w});
                distance[w] = d;
                before[w] = v;
                queue.insert({d, w});
            }
            h = surface.twin(Surface::prev(h));
        } while (h != surface.outgoing(v));
    }
    std::vector<int> path{end};
    while (path.back() != start) path.push_back(before[path.back()]);
    std::reverse(path.begin(), path.end());
    return path;
}

/// The whole unit sphere with three slit diffusion curves, no source.
inline Domain sphere_curves(int frequency) {
    const Surface sphere = icosphere(frequency);
    std::vector<Chain> chains(3);
    chains[0].vertices = edge_path(sphere, {0.9, 0.1, 0.4}, {0.2, 0.95, 0.2});
    chains[1].vertices = edge_path(sphere, {-0.7, 0.2, 0.7}, {-0.5, -0.6, 0.6});
    chains[2].vertices = edge_path(sphere, {0.5, -0.6, -0.6}, {-0.3, 0.3, -0.9});
    chains[0].left = [](const Point& p) { return 1 - 0.5 * p.x(); };
    chains[0].right = [](const Point& p) { return -0.4 + 0.3 * p.x(); };
    chains[1].left = [](const Point&) { return 0.2; };
    chains[1].right = [](const Point& p) { return 0.8 - p.y(); };
    chains[2].left = [](const Point&) { return -0.6; };
    chains[2].right = [](const Point& p) { return 0.5 * std::cos(3 * p.x()); };
    return slit_domain(sphere, chains);
}

/// A closed sharp Poisson curve (J = 1 + x, left inside) and a diffusion curve outside it, with a balanced source inside: nothing
/// but the jump holds the inside.
inline Domain island(int n) {
    const BentSquare square(n);
    std::vector<Chain> chains(2);
    chains[0].vertices = square.line({{0.3, 0.3}, {0.7, 0.3}, {0.7, 0.7}, {0.3, 0.7}, {0.3, 0.3}});
    chains[0].jump = [](const Point& p) { return 1 + p.x(); };
    chains[1].vertices = square.line({{0.1, 0.1}, {0.9, 0.1}});
    chains[1].left = [](const Point& p) { return p.x(); };
    chains[1].right = [](const Point&) { return 0.0; };
    Domain domain = square.domain(chains);
    add_disc_source(domain, {0.5, 0.5, 0}, 0.08, 0.13, -60);
    return domain;
}

}  // namespace pvg::fixtures
