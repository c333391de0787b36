// y is up, as in glTF, but for the plane, which lies in xy. Grids split their quads along alternating diagonals; surfaces of
// revolution have rings of as many vertices as their circumference asks for, so that triangles stay nearly equilateral.
#include "mesh/shapes.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "pvg/status.h"

namespace pvg {
namespace {

constexpr double pi = std::numbers::pi;

int cells(double size, double edge) { return std::max(1, static_cast<int>(std::lround(size / edge))); }

/// The edge length near `edge` for which count(edge) comes nearest to `vertices`.
double edge_for(double edge, int vertices, const std::function<long(double)>& count) {
    // First the right size, as counts go with the inverse square; then the best rounding around it.
    for (int i = 0; i < 30; ++i) edge *= std::sqrt(static_cast<double>(count(edge)) / vertices);
    double best = edge;
    for (int i = -60; i <= 60; ++i) {
        const double candidate = edge * (1 + i / 300.0);
        if (std::abs(count(candidate) - vertices) < std::abs(count(best) - vertices))
            best = candidate;
    }
    return best;
}

struct Corner {
    Point point;
    Point normal;
    Eigen::Vector2d texcoord;
};

/// Adds a grid of columns x rows quads; corner(i, j): column i to the right, row j up, seen from outside. keep(i, j): whether
/// that quad exists.
void add_grid(
    ShapeMesh& mesh, int columns, int rows, const std::function<Corner(int, int)>& corner,
    const std::function<bool(int, int)>& keep = [](int, int) { return true; }) {
    std::vector<int> index(static_cast<std::size_t>(columns + 1) * (rows + 1), none);
    const auto at = [&](int i, int j) {
        int& slot = index[static_cast<std::size_t>(j) * (columns + 1) + i];
        if (slot == none) {
            const Corner c = corner(i, j);
            slot = static_cast<int>(mesh.points.size());
            mesh.points.push_back(c.point);
            mesh.normals.push_back(c.normal);
            mesh.texcoords.push_back(c.texcoord);
        }
        return slot;
    };
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            if (!keep(i, j))
                continue;
            const int a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
            if ((i + j) % 2 == 0) {
                mesh.faces.push_back({a, b, c});
                mesh.faces.push_back({a, c, d});
            } else {
                mesh.faces.push_back({a, b, d});
                mesh.faces.push_back({b, c, d});
            }
        }
    }
}

/// Texture coordinates with v down, as in glTF.
Eigen::Vector2d grid_texcoord(int i, int columns, int j, int rows) {
    return {static_cast<double>(i) / columns, 1 - static_cast<double>(j) / rows};
}

/// Coordinates of a grid line; the same expression for every patch that shares it, so that borders weld bit for bit.
double line(double from, double to, int i, int count) { return i == count ? to : from + (to - from) * i / count; }

ShapeMesh make_plane(int vertices) {
    const int columns = std::max(1, static_cast<int>(std::lround(std::sqrt(vertices))) - 1);
    const int rows = std::max(1, static_cast<int>(std::lround(static_cast<double>(vertices) / (columns + 1))) - 1);
    ShapeMesh mesh;
    add_grid(mesh, columns, rows, [&](int i, int j) {
        return Corner{{line(-0.5, 0.5, i, columns), line(-0.5, 0.5, j, rows), 0}, {0, 0, 1}, grid_texcoord(i, columns, j, rows)};
    });
    return mesh;
}

/// Adds the six sides of the box between two corners, cells[k] quads along axis k. keep(side, i, j) as in add_grid; side 2 k + 1
/// faces +k.
using GridLines = std::array<std::vector<double>, 3>;
void add_box(ShapeMesh& mesh, const GridLines& lines, const std::function<bool(int, int, int)>& keep) {
    for (int side = 0; side < 6; ++side) {
        const int axis = side / 2;
        // Right and up on each side, so that right x up points outwards.
        int right = (axis + 1) % 3, up = (axis + 2) % 3;
        if (side % 2 == 0)
            std::swap(right, up);
        const int columns = static_cast<int>(lines[right].size()) - 1;
        const int rows = static_cast<int>(lines[up].size()) - 1;
        Point normal = Point::Zero();
        normal[axis] = side % 2 == 0 ? -1 : 1;
        add_grid(
            mesh, columns, rows,
            [&](int i, int j) {
                Point point;
                point[axis] = side % 2 == 0 ? lines[axis].front() : lines[axis].back();
                point[right] = lines[right][i];
                point[up] = lines[up][j];
                return Corner{point, normal, grid_texcoord(i, columns, j, rows)};
            },
            [&](int i, int j) { return keep(side, i, j); });
    }
}

std::vector<double> even_lines(double from, double to, int count) {
    std::vector<double> lines;
    for (int i = 0; i <= count; ++i) lines.push_back(line(from, to, i, count));
    return lines;
}

ShapeMesh make_cuboid(int vertices) {
    const Point size(1, 0.5, 0.7);
    const auto quads = [&](double edge) {
        const long x = cells(size[0], edge), y = cells(size[1], edge), z = cells(size[2], edge);
        return 2 * (x * y + y * z + z * x);
    };
    // A closed quad mesh of genus 0 has two vertices more than quads.
    const double edge = edge_for(std::sqrt(3.1 / vertices), vertices, [&](double e) { return quads(e) + 2; });
    GridLines lines;
    for (int k = 0; k < 3; ++k) lines[k] = even_lines(-size[k] / 2, size[k] / 2, cells(size[k], edge));
    ShapeMesh mesh;
    add_box(mesh, lines, [](int, int, int) { return true; });
    return mesh;
}

/// Rings 0 .. of a sphere of radius 0.5, five sectors like an icosahedron's: caps whose ring k has 5 k vertices, and between them
/// a belt of rings of 5 f vertices, each turned by half a step. Latitudes are evenly spaced; edges differ by less than 25 %.
ShapeMesh make_sphere(int vertices) {
    // f rings a cap, m steps in the belt: 2 + 5 f f + 5 f m vertices. m = f is the icosahedron's proportion.
    int f = 1, m = 1;
    double best = 1e300;
    const int guess = static_cast<int>(std::sqrt(vertices / 10.0));
    for (int i = std::max(1, guess - 2); i <= guess + 3; ++i) {
        for (int j = std::max(1, i / 2); j <= 2 * i; ++j) {
            const double count = 2 + 5.0 * i * i + 5.0 * i * j;
            const double cost = std::abs(count / vertices - 1) + 0.1 * std::abs(static_cast<double>(j) / i - 1);
            if (cost < best) {
                best = cost;
                f = i;
                m = j;
            }
        }
    }

    ShapeMesh mesh;
    const int rings = 2 * f + m;
    std::vector<int> first;
    for (int k = 0; k <= rings; ++k) {
        const int steps = 5 * std::min({k, rings - k, f});  // 0 at the poles
        const double theta = pi * k / rings;
        const double turn = 0.5 * std::clamp(k - f, 0, m) / (5.0 * f);
        first.push_back(static_cast<int>(mesh.points.size()));
        // The seam's vertices stand twice, a pole's once a sector. The texture follows the turn of the belt.
        for (int j = 0; j <= (steps == 0 ? 4 : steps); ++j) {
            const double phi = 2 * pi * (steps == 0 ? 0 : turn + static_cast<double>(j % steps) / steps);
            Point normal(std::sin(theta) * std::cos(phi), std::cos(theta), -std::sin(theta) * std::sin(phi));
            if (steps == 0)
                normal = Point(0, k == 0 ? 1 : -1, 0);
            mesh.points.push_back(0.5 * normal);
            mesh.normals.push_back(normal);
            mesh.texcoords.emplace_back(steps == 0 ? (j + 0.5) / 5 : static_cast<double>(j) / steps,
                                        static_cast<double>(k) / rings);
        }
    }
    const auto at = [&](int ring, int j) { return first[ring] + j; };
    for (int k = 0; k < rings; ++k) {
        if (k >= f && k < f + m) {
            for (int j = 0; j < 5 * f; ++j) {
                mesh.faces.push_back({at(k, j), at(k + 1, j), at(k, j + 1)});
                mesh.faces.push_back({at(k + 1, j), at(k + 1, j + 1), at(k, j + 1)});
            }
            continue;
        }
        const bool north = k < f;
        const int small = north ? k : rings - k - 1;  // steps a sector on the ring nearer the pole
        const int inner = north ? k : k + 1, outer = north ? k + 1 : k;
        for (int s = 0; s < 5; ++s) {
            const auto a = [&](int j) { return small == 0 ? at(inner, s) : at(inner, s * small + j); };
            const auto b = [&](int j) { return at(outer, s * (small + 1) + j); };
            for (int j = 0; j <= small; ++j) {
                mesh.faces.push_back(north ? Face{a(j), b(j), b(j + 1)} : Face{a(j), b(j + 1), b(j)});
                if (j < small)
                    mesh.faces.push_back(north ? Face{a(j), b(j + 1), a(j + 1)} : Face{a(j), a(j + 1), b(j + 1)});
            }
        }
    }
    return mesh;
}

ShapeMesh make_torus(int vertices) {
    const double large = 0.35, small = 0.15;
    const int around_tube = std::max(3, static_cast<int>(std::lround(std::sqrt(vertices * small / large))));
    const int around = std::max(3, static_cast<int>(std::lround(static_cast<double>(vertices) / around_tube)));
    ShapeMesh mesh;
    add_grid(mesh, around, around_tube, [&](int i, int j) {
        const double phi = 2 * pi * (i % around) / around;
        const double theta = 2 * pi * (j % around_tube) / around_tube;
        const Point normal(std::cos(theta) * std::cos(phi), std::sin(theta), -std::cos(theta) * std::sin(phi));
        const Point center(large * std::cos(phi), 0, -large * std::sin(phi));
        return Corner{center + small * normal, normal, grid_texcoord(i, around, j, around_tube)};
    });
    return mesh;
}

/// A curve in the half plane (radius, height) by arc length, from a Catmull-Rom spline through its points. It begins and ends on
/// the axis.
class Profile {
public:
    explicit Profile(const std::vector<Eigen::Vector2d>& points) {
        const int count = static_cast<int>(points.size());
        for (int k = 0; k + 1 < count; ++k) {
            // Beyond the axis the curve goes on as its mirror image, so that it meets the axis at a right angle.
            const auto mirrored = [](Eigen::Vector2d p) { return Eigen::Vector2d(-p[0], p[1]); };
            const Eigen::Vector2d a = k > 0 ? points[k - 1] : mirrored(points[1]);
            const Eigen::Vector2d d = k + 2 < count ? points[k + 2] : mirrored(points[count - 2]);
            for (int i = 0; i < samples; ++i) {
                const double t = static_cast<double>(i) / samples;
                add(0.5 * ((2 * points[k]) + (points[k + 1] - a) * t + (2 * a - 5 * points[k] + 4 * points[k + 1] - d) * t * t +
                           (3 * points[k] - a - 3 * points[k + 1] + d) * t * t * t));
            }
        }
        add(points.back());
    }

    double length() const { return length_.back(); }
    Eigen::Vector2d at(double s) const {
        const std::size_t k = segment(s);
        return points_[k] + (points_[k + 1] - points_[k]) * ((s - length_[k]) / (length_[k + 1] - length_[k]));
    }
    /// To the right of the direction of travel.
    Eigen::Vector2d normal(double s) const {
        const double reach = length() / 2000;
        const Eigen::Vector2d along = at(std::min(length(), s + reach)) - at(std::max(0.0, s - reach));
        return Eigen::Vector2d(along[1], -along[0]).normalized();
    }

private:
    static constexpr int samples = 64;
    std::vector<Eigen::Vector2d> points_;
    std::vector<double> length_;
    void add(const Eigen::Vector2d& point) {
        length_.push_back(points_.empty() ? 0 : length_.back() + (point - points_.back()).norm());
        points_.push_back(point);
    }
    std::size_t segment(double s) const {
        const auto above = std::upper_bound(length_.begin(), length_.end(), s);
        return std::clamp<std::ptrdiff_t>(above - length_.begin(), 1, static_cast<std::ptrdiff_t>(length_.size()) - 1) - 1;
    }
};

/// Turns a profile about the y axis. The profile runs from the bottom outwards and up: outside is on its right.
ShapeMesh revolve(const Profile& profile, int vertices) {
    const auto ring_count = [&](double edge) {
        return std::max(3, static_cast<int>(std::lround(profile.length() / (0.9 * edge))));
    };
    const auto steps = [&](int k, double edge) {
        const double radius = profile.at(profile.length() * k / ring_count(edge))[0];
        return std::max(5, static_cast<int>(std::lround(2 * pi * radius / edge)));
    };
    const double edge = edge_for(std::sqrt(4.0 / vertices), vertices, [&](double e) {
        long count = 2;
        for (int k = 1; k < ring_count(e); ++k) count += steps(k, e);
        return count;
    });

    ShapeMesh mesh;
    const int rings = ring_count(edge);
    std::vector<int> first, count;
    for (int k = 0; k <= rings; ++k) {
        const bool pole = k == 0 || k == rings;
        const double s = profile.length() * k / rings;
        const Eigen::Vector2d at = profile.at(s), out = profile.normal(s);
        const int n = pole ? steps(k == 0 ? 1 : rings - 1, edge) : steps(k, edge);
        first.push_back(static_cast<int>(mesh.points.size()));
        count.push_back(n);
        for (int j = 0; j < (pole ? n : n + 1); ++j) {
            const double phi = 2 * pi * (j % n) / n;
            mesh.points.push_back(pole ? Point(0, at[1], 0) : Point(at[0] * std::cos(phi), at[1], -at[0] * std::sin(phi)));
            mesh.normals.push_back(pole ? Point(0, out[1] > 0 ? 1 : -1, 0)
                                        : Point(out[0] * std::cos(phi), out[1], -out[0] * std::sin(phi)));
            mesh.texcoords.emplace_back((j + (pole ? 0.5 : 0.0)) / n, 1 - static_cast<double>(k) / rings);
        }
    }
    for (int k = 0; k < rings; ++k) {
        const int low = first[k], high = first[k + 1], n = count[k], m = count[k + 1];
        if (k == 0 || k + 1 == rings) {
            for (int j = 0; j < n; ++j)
                mesh.faces.push_back(k == 0 ? Face{low + j, high + j + 1, high + j} : Face{low + j, low + j + 1, high + j});
            continue;
        }
        for (int i = 0, j = 0; i < n || j < m;) {
            // Whichever ring's next step is nearer goes on; steps that tie alternate.
            const long ahead = (2L * i + 1) * m - (2L * j + 1) * n;
            const bool low_goes = j == m || (i < n && (ahead < 0 || (ahead == 0 && (i + k) % 2 == 0)));
            if (low_goes)
                mesh.faces.push_back({low + i, low + i + 1, high + j}), ++i;
            else
                mesh.faces.push_back({low + i, high + j + 1, high + j}), ++j;
        }
    }
    return mesh;
}

ShapeMesh make_vase(int vertices) {
    // Foot, belly, shoulder, neck and a turned lip, then back down inside with a wall of about 0.03.
    return revolve(
        Profile({{0, -0.485},    {0.07, -0.485}, {0.115, -0.495}, {0.15, -0.49},   {0.155, -0.47}, {0.13, -0.44}, {0.14, -0.40},
                 {0.20, -0.30},  {0.265, -0.17}, {0.29, -0.02},   {0.265, 0.13},   {0.20, 0.25},   {0.14, 0.335}, {0.125, 0.40},
                 {0.145, 0.455}, {0.18, 0.49},   {0.172, 0.503},  {0.15, 0.495},   {0.115, 0.465}, {0.095, 0.40}, {0.11, 0.32},
                 {0.17, 0.23},   {0.235, 0.115}, {0.26, -0.02},   {0.235, -0.155}, {0.17, -0.28},  {0.10, -0.37}, {0, -0.40}}),
        vertices);
}

ShapeMesh make_stele(int vertices) {
    const Point base(0.31, 0.12, 0.19);  // half width, height, half depth
    const Point slab(0.23, 0.93, 0.08);  // half width, height of the springing line above the ground, half depth
    const double rise = 0.07;            // of the arch
    const double radius = (slab[0] * slab[0] + rise * rise) / (2 * rise);
    const auto arch = [&](double x) {
        return std::sqrt(radius * radius - x * x) - std::sqrt(radius * radius - slab[0] * slab[0]);
    };
    struct Cells {
        int across, through, margin_x, margin_z, base_rows, rows;
    };
    const auto divide = [&](double edge) {
        return Cells{cells(2 * slab[0], edge),       cells(2 * slab[2], edge), cells(base[0] - slab[0], edge),
                     cells(base[2] - slab[2], edge), cells(base[1], edge),     cells(slab[1] + 0.7 * rise - base[1], edge)};
    };
    const double edge = edge_for(std::sqrt(2.0 / vertices), vertices, [&](double e) {
        const Cells c = divide(e);
        const long x = c.across + 2 * c.margin_x, z = c.through + 2 * c.margin_z;
        return 2 * x * z + 2 * c.base_rows * (x + z) + 2L * c.rows * (c.across + c.through) + 2;
    });
    const Cells c = divide(edge);

    // Grid lines of the base pass through the slab's corners, so that the slab stands on its vertices.
    const auto with_margins = [](double outer, double inner, int margin, int middle) {
        std::vector<double> lines = even_lines(-outer, -inner, margin);
        const std::vector<double> mid = even_lines(-inner, inner, middle), end = even_lines(inner, outer, margin);
        lines.insert(lines.end(), mid.begin() + 1, mid.end());
        lines.insert(lines.end(), end.begin() + 1, end.end());
        return lines;
    };
    const double ground = -0.5;
    const GridLines lines{with_margins(base[0], slab[0], c.margin_x, c.across), even_lines(ground, ground + base[1], c.base_rows),
                          with_margins(base[2], slab[2], c.margin_z, c.through)};
    const std::vector<double> xs = even_lines(-slab[0], slab[0], c.across), zs = even_lines(-slab[2], slab[2], c.through);
    const auto height = [&](double x, int row) {
        const bool end = std::abs(x) >= slab[0];
        return line(ground + base[1], ground + slab[1] + (end ? 0 : arch(x)), row, c.rows);
    };

    ShapeMesh mesh;
    add_box(mesh, lines, [&](int side, int i, int j) {  // on the top, right is z and up is x
        return side != 3 || i < c.margin_z || i >= c.margin_z + c.through || j < c.margin_x || j >= c.margin_x + c.across;
    });
    for (const int face : {1, -1}) {
        add_grid(mesh, c.across, c.rows, [&](int i, int j) {  // front and back
            const double x = xs[face > 0 ? i : c.across - i];
            return Corner{{x, height(x, j), face * slab[2]}, {0, 0, 1.0 * face}, grid_texcoord(i, c.across, j, c.rows)};
        });
        add_grid(mesh, c.through, c.rows, [&](int i, int j) {  // right and left end
            const double z = zs[face > 0 ? c.through - i : i];
            return Corner{
                {face * slab[0], height(face * slab[0], j), z}, {1.0 * face, 0, 0}, grid_texcoord(i, c.through, j, c.rows)};
        });
    }
    add_grid(mesh, c.across, c.through, [&](int i, int j) {  // the arch, from above
        const double x = xs[i];
        const Point normal = Point(x, std::sqrt(radius * radius - x * x), 0) / radius;
        return Corner{{x, height(x, c.rows), zs[c.through - j]}, normal, grid_texcoord(i, c.across, j, c.through)};
    });
    return mesh;
}

}  // namespace

const std::vector<std::string>& shape_names() {
    static const std::vector<std::string> names{"cuboid", "sphere", "plane", "torus", "vase", "stele"};
    return names;
}

ShapeMesh make_shape(const std::string& shape, int vertices) {
    if (vertices < 8)
        throw Error(ErrorKind::usage, "a shape needs at least 8 vertices, found " + std::to_string(vertices));
    if (vertices > 50000000)
        throw Error(ErrorKind::usage, "a shape has at most 50000000 vertices, found " + std::to_string(vertices));
    if (shape == "cuboid")
        return make_cuboid(vertices);
    if (shape == "sphere")
        return make_sphere(vertices);
    if (shape == "plane")
        return make_plane(vertices);
    if (shape == "torus")
        return make_torus(vertices);
    if (shape == "vase")
        return make_vase(vertices);
    if (shape == "stele")
        return make_stele(vertices);
    std::string names;
    for (const std::string& name : shape_names()) names += (names.empty() ? "" : ", ") + name;
    throw Error(ErrorKind::usage, "unknown shape \"" + shape + "\"; the shapes are " + names);
}

}  // namespace pvg
