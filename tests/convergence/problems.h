// The closed forms of fixtures/analytic.h as domains at any resolution: n edges a unit length, about. Vertices that no curve
// holds are shaken, so that nothing rests on the symmetry of a grid; curves, rims and the borders of sources run along edges.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <numbers>
#include <string>
#include <utility>

#include "fixtures/analytic.h"
#include "fixtures/domains.h"
#include "solve/basis_problems.h"

namespace pvg::fixtures {

struct AnalyticProblem {
    std::string name;
    Domain domain;  ///< one channel
    Eigen::VectorXd truth;
};

inline double angle_of(const Point& p) { return std::atan2(p.y(), p.x()); }

/// A band of staggered rows t = 0 ... 1 around phi; rows that are neither borders nor still are shaken. chart: (phi, t) to space.
inline Surface shaken_band(int columns, int rows, const std::function<bool(int)>& still,
                           const std::function<Point(double, double)>& chart) {
    constexpr double amount = 0.3;
    Random random(7);
    return grid(columns, rows + 1, true, [&](int i, int j) {
        const double a = random.real(-0.5, 0.5), b = random.real(-0.5, 0.5);
        const bool free = j > 0 && j < rows && !still(j);
        return chart(2 * std::numbers::pi * (i + 0.5 * (j % 2) + free * amount * a) / columns, (j + free * amount * b) / rows);
    });
}

/// Rows for triangles that are nearly equilateral where an edge is 1 / n long; a multiple of `multiple`.
inline int rows_for(double length, int n, int multiple = 1) {
    return multiple * std::max(1, static_cast<int>(std::lround(length * n / (std::sqrt(0.75) * multiple))));
}

/// The value of each vertex that is fixed from the closed form too.
inline AnalyticProblem with_truth(std::string name, Domain domain, const std::function<double(int)>& u) {
    AnalyticProblem problem{std::move(name), std::move(domain), {}};
    problem.truth.resize(problem.domain.surface.vertex_count());
    for (int v = 0; v < problem.truth.size(); ++v) {
        problem.truth[v] = u(v);
        if (problem.domain.dirichlet[v])
            problem.domain.dirichlet_value(v, 0) = problem.truth[v];
    }
    return problem;
}

inline void fix_borders(Domain& domain) {
    for (int v = 0; v < domain.surface.vertex_count(); ++v)
        if (domain.surface.is_border_vertex(v))
            fix(domain, v, 0);
}

/// One source over all faces, f by the centroid (0: none there).
inline void add_source(Domain& domain, const std::function<double(const Point&)>& f) {
    SourceColumn source;
    source.primitive = "source";
    for (int t = 0; t < domain.surface.face_count(); ++t) {
        const Face& face = domain.surface.face(t);
        const double value =
            f((domain.surface.point(face[0]) + domain.surface.point(face[1]) + domain.surface.point(face[2])) / 3);
        if (value != 0)
            source.profile.push_back({t, value});
    }
    source.value = Eigen::RowVectorXd::Ones(1);
    domain.sources.push_back(std::move(source));
}

/// The unit disk of n rings without sources, its rim fixed; vertices off the still rings shaken.
inline Domain shaken_disk(
    int n, const std::function<bool(int)>& still = [](int) { return false; }) {
    Domain domain = disk_domain(n, 0);
    Random random(3);
    std::vector<Point> points = domain.surface.points();
    for (Point& p : points) {
        const Point step(random.real(-0.15, 0.15) / n, random.real(-0.15, 0.15) / n, 0);
        const int ring = static_cast<int>(std::lround(p.norm() * n));
        if (ring < n && !still(ring))
            p += step;
    }
    domain.surface = Surface(std::move(points), domain.surface.faces());
    return domain;
}

inline AnalyticProblem sphere_band_problem(int n) {
    const double low = 0.7, high = 2.2;
    const auto wanted = static_cast<int>(2 * std::numbers::pi * (high - low) * n * n / std::sqrt(0.75));
    Domain domain = sphere_band(wanted, low, high).domain;
    const std::vector<Point> p = domain.surface.points();
    return with_truth("sphere band", std::move(domain), [&](int v) {
        return analytic::SphereBand{low, high}(std::atan2(std::hypot(p[v].x(), p[v].y()), p[v].z()));
    });
}

inline AnalyticProblem disk_harmonic_problem(int n, int degree = 3) {
    Domain domain = shaken_disk(n);
    const std::vector<Point> p = domain.surface.points();
    return with_truth("disk with harmonic rim", std::move(domain), [&](int v) {
        return analytic::DiskHarmonic{degree, 0.3}(p[v].x(), p[v].y());
    });
}

inline AnalyticProblem disk_source_problem(int n) {
    Domain domain = shaken_disk(n);
    add_source(domain, [](const Point&) { return -4; });
    const std::vector<Point> p = domain.surface.points();
    return with_truth("disk with source", std::move(domain), [&](int v) { return analytic::DiskSource{1, -4}(p[v].norm()); });
}

/// n a multiple of 6.
inline AnalyticProblem balanced_region_problem(int n) {
    const analytic::BalancedRegion u{2.0 / 3, 0.5, 1};
    Domain domain = shaken_disk(n, [&](int ring) { return 3 * ring == 2 * n || 2 * ring == n; });
    // Faces between two rings have their centroids strictly between them.
    add_source(domain, [&](const Point& c) {
        return c.norm() < u.inner ? u.laplacian() : c.norm() < u.border * (1 - 1e-3) ? u.ring_laplacian() : 0.0;
    });
    for (int v = 0; v < domain.surface.vertex_count(); ++v)
        for (double r : {u.inner, u.border}) domain.on_curve[v] |= std::abs(domain.surface.point(v).norm() - r) < 1e-9;
    const std::vector<Point> p = domain.surface.points();
    return with_truth("disk with balanced region", std::move(domain), [&](int v) { return u(p[v].norm()); });
}

inline AnalyticProblem open_slit_problem(int n) {
    const Domain whole = shaken_disk(n, [](int) { return false; });
    // The spoke along x keeps its place: vertex 0 of every ring.
    const Domain even = disk_domain(n, 0);
    std::vector<Point> points = whole.surface.points();
    std::vector<Chain> chains(1);
    chains[0].left = chains[0].right = [](const Point&) { return 0.0; };
    for (int ring = 0; ring <= n; ++ring) {
        const int v = ring == 0 ? 0 : 1 + 3 * ring * (ring - 1);
        points[v] = even.surface.point(v);
        chains[0].vertices.push_back(v);
    }
    Domain domain = slit_domain(Surface(std::move(points), whole.surface.faces()), chains);
    for (int v = 0; v < domain.surface.vertex_count(); ++v)
        if (domain.surface.point(v).norm() > 1 - 1e-9)
            fix(domain, v, 0);
    const std::vector<Point> p = domain.surface.points();
    return with_truth("open slit", std::move(domain), [&](int v) {
        const double angle = angle_of(p[v]);  // on both copies of the slit u is 0
        return std::abs(p[v].y()) < 1e-12 && p[v].x() >= 0
                   ? 0.0
                   : analytic::OpenSlit{1}(p[v].norm(), angle < 0 ? angle + 2 * std::numbers::pi : angle);
    });
}

inline Point on_cylinder(double phi, double s) { return {std::cos(phi), std::sin(phi), s}; }
inline int columns_for(int n) { return static_cast<int>(std::lround(2 * std::numbers::pi * n)); }

inline void fix_rims(Domain& domain, double length) {
    for (int v = 0; v < domain.surface.vertex_count(); ++v)
        if (domain.surface.point(v).z() < 1e-9 || domain.surface.point(v).z() > length - 1e-9)
            fix(domain, v, 0);
}

/// Per vertex, whether it is on the left of a Poisson curve at s = at: beyond it, or a left copy on it.
inline std::vector<char> left_of_jump(const Domain& domain, double at) {
    std::vector<char> left(domain.surface.vertex_count(), 0);
    for (int v = 0; v < domain.surface.vertex_count(); ++v) left[v] = domain.surface.point(v).z() > at + 1e-9;
    for (const Coupling& coupling : domain.couplings) left[coupling.left] = 1;
    return left;
}

inline AnalyticProblem cylinder_problem(int n) {
    const double length = 2;
    Domain domain = plain_domain(shaken_band(
        columns_for(n), rows_for(length, n), [](int) { return false; },
        [&](double phi, double t) { return on_cylinder(phi, length * t); }));
    fix_borders(domain);
    const std::vector<Point> p = domain.surface.points();
    const analytic::CylinderMode u{length, 1, 2, 0.5, 1};
    return with_truth("cylinder", std::move(domain), [&](int v) { return u(p[v].z(), angle_of(p[v])); });
}

/// Slit along v = 0: the two sides are the band's two rims. mode 0: the ramp.
inline AnalyticProblem torus_problem(int n, int mode = 2) {
    const analytic::Torus torus{1, 0.4};
    const int rows = rows_for(2 * std::numbers::pi * torus.minor, n), columns = columns_for(n);
    Domain domain = plain_domain(shaken_band(
        columns, rows, [](int) { return false; },
        [&](double phi, double t) {
            const double v = 2 * std::numbers::pi * t, r = torus.major + torus.minor * std::cos(v);
            return Point(r * std::cos(phi), r * std::sin(phi), torus.minor * std::sin(v));
        }));
    fix_borders(domain);
    const std::vector<Point> p = domain.surface.points();
    return with_truth(mode == 0 ? "torus with ramp" : "torus", std::move(domain), [&](int vertex) {
        double v = std::atan2(p[vertex].z(), std::hypot(p[vertex].x(), p[vertex].y()) - torus.major);
        if (vertex < columns)
            v = 0;
        else if (vertex >= rows * columns)
            v = 2 * std::numbers::pi;
        else if (v < 0)
            v += 2 * std::numbers::pi;
        return mode == 0 ? torus.ramp(v) : torus.mode(mode, angle_of(p[vertex]), v);
    });
}

/// The polyhedral flat torus slit along its lower ring; each of its triangles in n^2, the vertices inside them shaken.
inline AnalyticProblem flat_torus_problem(int n) {
    const analytic::FlatTorus torus{8, 1.0, 0.15, 2};
    const analytic::FlatTorus::Joint outer = torus.outer(), inner = torus.inner();
    const int N = torus.points;
    const double a = torus.side();
    struct Corner {
        Point place;
        double s, v;
    };
    const auto ring = [&](int i, double z, double turned) {
        const double angle = 2 * std::numbers::pi * i / N + turned;
        return Point(std::cos(angle), std::sin(angle), z);
    };
    // Lower ends A at v = 0 (outer) and v = length (inner), upper ends B between.
    const auto low = [&](int i) { return Corner{ring(i, 0, 0), i * a, 0}; };
    const auto up = [&](int j) { return Corner{ring(j, torus.height, torus.twist), j * a + outer.along, outer.across}; };
    const auto back = [&](int i) { return Corner{ring(i, 0, 0), i * a + torus.shift(), outer.across + inner.across}; };
    std::vector<std::array<Corner, 3>> triangles;
    for (int i = 0; i < N; ++i) {
        const int t = i + torus.turn;
        triangles.push_back({low(i), low(i + 1), up(i)});
        triangles.push_back({low(i + 1), up(i + 1), up(i)});
        triangles.push_back({back(i + 1), back(i), up(t)});
        triangles.push_back({back(i + 1), up(t), up(t + 1)});
    }
    Random random(9);
    std::vector<Point> points;
    std::vector<Eigen::Vector2d> unfolded;
    std::map<std::array<long, 3>, int> number;
    std::vector<Face> faces;
    for (const auto& [p, q, r] : triangles) {
        std::vector<std::vector<int>> at(n + 1);
        for (int i = 0; i <= n; ++i)
            for (int j = 0; i + j <= n; ++j) {
                double x = i, y = j;
                if (i > 0 && j > 0 && i + j < n) {
                    x += random.real(-0.2, 0.2);
                    y += random.real(-0.2, 0.2);
                }
                const double wq = x / n, wr = y / n, wp = 1 - wq - wr;
                const Point place = wp * p.place + wq * q.place + wr * r.place;
                const auto key = [&](int k) { return std::lround(place[k] * 1e7); };
                const auto [found, fresh] = number.try_emplace({key(0), key(1), key(2)}, static_cast<int>(points.size()));
                if (fresh) {
                    points.push_back(place);
                    unfolded.emplace_back(wp * p.s + wq * q.s + wr * r.s, wp * p.v + wq * q.v + wr * r.v);
                }
                at[i].push_back(found->second);
            }
        for (int i = 0; i < n; ++i)
            for (int j = 0; i + j < n; ++j) {
                faces.push_back({at[i][j], at[i + 1][j], at[i][j + 1]});
                if (i + j + 1 < n)
                    faces.push_back({at[i + 1][j], at[i + 1][j + 1], at[i][j + 1]});
            }
    }
    const Surface whole(std::move(points), std::move(faces));
    std::vector<std::pair<double, int>> along;
    for (int v = 0; v < whole.vertex_count(); ++v)
        if (std::abs(whole.point(v).z()) < 1e-9)
            along.emplace_back(angle_of(whole.point(v)), v);
    std::sort(along.begin(), along.end());
    std::vector<Chain> chains(1);
    for (const auto& [angle, v] : along) chains[0].vertices.push_back(v);
    chains[0].vertices.push_back(along.front().second);
    chains[0].left = chains[0].right = [](const Point&) { return 0.0; };
    Domain domain = slit_domain(whole, chains);
    const std::vector<int> parent = domain.vertex_parent;
    return with_truth("flat torus", std::move(domain), [&](int v) {
        const Eigen::Vector2d& at = unfolded[parent[v]];
        // On the slit the inner joint's unfolding may have come first; the value is the same.
        return torus.mode(1, at[0], at[1]);
    });
}

/// A sharp Poisson curve around a cylinder whose rims are at 0; the jump varies with the angle.
inline AnalyticProblem cylinder_jump_problem(int n) {
    const analytic::CylinderJumpMode u{2, 0.8, 2, 0.7};
    const int columns = columns_for(n), rows = rows_for(u.length, n, 5), middle = rows * 2 / 5;
    const Surface whole = shaken_band(
        columns, rows, [&](int row) { return row == middle; },
        [&](double phi, double t) { return on_cylinder(phi, u.length * t); });
    std::vector<Chain> chains(1);
    for (int i = 0; i <= columns; ++i) chains[0].vertices.push_back(middle * columns + i % columns);
    chains[0].jump = [&](const Point& p) { return u.jump * std::cos(u.n * angle_of(p)); };
    Domain domain = slit_domain(whole, chains);
    fix_rims(domain, u.length);
    const std::vector<char> left = left_of_jump(domain, u.at);
    const std::vector<Point> p = domain.surface.points();
    return with_truth("cylinder with jump", std::move(domain), [&](int v) { return u(p[v].z(), angle_of(p[v]), left[v]); });
}

/// An even jump between rims at 0 and 1, on a prism: it is flat along its length, so linear elements are exact.
inline AnalyticProblem prism_step_problem(int n) {
    const analytic::CylinderStep u{2, 0.8, 0.7, 0, 1};
    const int columns = columns_for(n), rows = 5 * std::max(1, 2 * n / 5), middle = rows * 2 / 5;
    std::vector<Chain> chains(1);
    for (int i = 0; i <= columns; ++i) chains[0].vertices.push_back(middle * columns + i % columns);
    chains[0].jump = [&](const Point&) { return u.jump; };
    Domain domain = slit_domain(cylinder(columns, rows, 1, u.length), chains);
    fix_rims(domain, u.length);
    const std::vector<char> left = left_of_jump(domain, u.at);
    const std::vector<Point> p = domain.surface.points();
    return with_truth("prism with even jump", std::move(domain),
                      [&](int v) { return left[v] ? u(std::max(p[v].z(), u.at)) : u(p[v].z() - 1e-12); });
}

/// A Poisson curve of width 0.4 around a cylinder between rims at 0 and 1: strips as two sources' faces.
inline AnalyticProblem cylinder_wide_step_problem(int n) {
    const analytic::CylinderStep u{2, 0.8, 0.7, 0.4, 1};
    const int columns = columns_for(n), rows = rows_for(u.length, n, 5), middle = rows * 2 / 5, reach = rows / 5;
    const auto still = [&](int row) { return row == middle || std::abs(row - middle) == reach; };
    Domain domain =
        plain_domain(shaken_band(columns, rows, still, [&](double phi, double t) { return on_cylinder(phi, u.length * t); }));
    fix_borders(domain);
    add_source(domain, [&](const Point& c) { return u.laplacian(c.z()); });
    for (int v = 0; v < domain.surface.vertex_count(); ++v) domain.on_curve[v] |= still(v / columns);
    const std::vector<Point> p = domain.surface.points();
    return with_truth("cylinder with wide step", std::move(domain), [&](int v) { return u(p[v].z()); });
}

}  // namespace pvg::fixtures
