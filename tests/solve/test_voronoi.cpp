#include "solve/voronoi.h"

#include <map>

#include <gtest/gtest.h>

#include "fixtures/domains.h"
#include "geodesic/geodesic.h"
#include "geodesic/paths.h"
#include "pvg/status.h"

namespace pvg {
namespace {

using fixtures::plain_domain;
using std::numbers::pi;

Knots knots_at(const Surface& surface, std::vector<int> vertices) {
    std::sort(vertices.begin(), vertices.end());
    Knots knots;
    knots.vertex = std::move(vertices);
    knots.knot_of_vertex.assign(surface.vertex_count(), none);
    for (std::size_t k = 0; k < knots.vertex.size(); ++k) knots.knot_of_vertex[knots.vertex[k]] = static_cast<int>(k);
    return knots;
}

/// About `share` of the vertices.
Knots some_knots(const Surface& surface, double share, std::uint64_t seed = 5) {
    fixtures::Random random(seed);
    std::vector<int> vertices{0};
    for (int v = 1; v < surface.vertex_count(); ++v)
        if (random.real() < share)
            vertices.push_back(v);
    return knots_at(surface, vertices);
}

Surface rough_ball(int frequency, double roughness) {
    const Surface ball = fixtures::icosphere(frequency);
    fixtures::Random random(3);
    std::vector<Point> points = ball.points();
    for (Point& p : points) p *= 1 + roughness * (random.real() - 0.5);
    return Surface(std::move(points), ball.faces());
}

Surface hills() {
    return fixtures::lifted(fixtures::irregular_plane(30, 30),
                            [](double x, double y) { return 0.1 * std::sin(9 * x) * std::cos(7 * y); });
}

std::vector<std::pair<const char*, Surface>> surfaces() {
    std::vector<std::pair<const char*, Surface>> all;
    all.emplace_back("plane", fixtures::irregular_plane(25, 25));
    all.emplace_back("grid", fixtures::plane(20, 20));
    all.emplace_back("slits", fixtures::slit_square(1500).domain.surface);
    all.emplace_back("band", fixtures::sphere_band(2000).domain.surface);
    all.emplace_back("L", fixtures::l_shape(8));
    all.emplace_back("torus", fixtures::torus(30, 45));
    all.emplace_back("tube", fixtures::cylinder(12, 20));
    all.emplace_back("hills", hills());
    all.emplace_back("rough ball", rough_ball(9, 0.1));
    all.emplace_back("cuboid", fixtures::cuboid());
    all.emplace_back("cone", fixtures::cone(7, 2));
    return all;
}

using Weights = std::map<std::pair<int, int>, CellEdge>;
Weights by_pair(const Voronoi& voronoi) {
    Weights all;
    for (const CellEdge& edge : voronoi.edges) all[{edge.a, edge.b}] = edge;
    return all;
}

TEST(Voronoi, PiecesAddUpToFacesAndCellsToTheSurface) {
    for (const auto& [name, surface] : surfaces())
        for (double share : {0.02, 0.15, 0.5, 1.0}) {
            SCOPED_TRACE(std::string(name) + " " + std::to_string(share));
            const Voronoi voronoi = geodesic_voronoi(plain_domain(surface), some_knots(surface, share));
            std::vector<double> face(surface.face_count(), 0), cell(voronoi.area.size(), 0);
            for (std::size_t i = 0; i < voronoi.pieces.size(); ++i) {
                const CellPiece& piece = voronoi.pieces[i];
                EXPECT_GE(piece.area, 0);
                face[piece.face] += piece.area;
                cell[piece.cell] += piece.area;
                if (i > 0) {
                    EXPECT_TRUE(std::pair(voronoi.pieces[i - 1].face, voronoi.pieces[i - 1].cell) <
                                std::pair(piece.face, piece.cell));
                }
            }
            double sum = 0;
            // rounding of areas of order 1e-2
            for (int f = 0; f < surface.face_count(); ++f) EXPECT_NEAR(face[f], surface.face_area(f), 1e-13);
            for (std::size_t j = 0; j < cell.size(); ++j) {
                EXPECT_NEAR(cell[j], voronoi.area[j], 1e-13);
                EXPECT_GT(voronoi.area[j], 0);
                sum += voronoi.area[j];
            }
            EXPECT_NEAR(sum / surface.area(), 1, 1e-12);
        }
}

TEST(Voronoi, AdjacencyIsSymmetricSortedAndPositive) {
    for (const auto& [name, surface] : surfaces()) {
        SCOPED_TRACE(name);
        const Voronoi voronoi = geodesic_voronoi(plain_domain(surface), some_knots(surface, 0.1));
        std::size_t seen = 0;
        for (std::size_t i = 0; i + 1 < voronoi.neighbour_first.size(); ++i)
            for (int k = voronoi.neighbour_first[i]; k < voronoi.neighbour_first[i + 1]; ++k, ++seen) {
                const int j = voronoi.neighbours[k];
                EXPECT_NE(j, static_cast<int>(i));
                if (k > voronoi.neighbour_first[i]) {
                    EXPECT_LT(voronoi.neighbours[k - 1], j);
                }
                const auto begin = voronoi.neighbours.begin() + voronoi.neighbour_first[j],
                           end = voronoi.neighbours.begin() + voronoi.neighbour_first[j + 1];
                EXPECT_TRUE(std::binary_search(begin, end, static_cast<int>(i)));
            }
        EXPECT_EQ(seen, 2 * voronoi.edges.size());
        for (std::size_t e = 0; e < voronoi.edges.size(); ++e) {
            const CellEdge& edge = voronoi.edges[e];
            EXPECT_LT(edge.a, edge.b);
            EXPECT_GT(edge.weight, 0);
            EXPECT_GT(edge.length, 0);
            EXPECT_GT(edge.distance, 0);
            EXPECT_LE(edge.weight, edge.length / edge.distance * (1 + 1e-12));
            if (e > 0) {
                EXPECT_TRUE(std::pair(voronoi.edges[e - 1].a, voronoi.edges[e - 1].b) < std::pair(edge.a, edge.b));
            }
        }
    }
}

TEST(Voronoi, DistancesAreTheGeodesicOnes) {
    for (const auto& [name, surface] : surfaces()) {
        SCOPED_TRACE(name);
        const Knots knots = some_knots(surface, 0.05);
        const Voronoi voronoi = geodesic_voronoi(plain_domain(surface), knots);
        std::vector<GeodesicSource> sources;
        for (int v : knots.vertex) sources.push_back({at_vertex(surface, v), 0});
        const GeodesicField field = geodesic_distances(surface, sources);
        // Two independent exact solvers: rounding only. Where two paths tie, knot and direction may be either's.
        for (int v = 0; v < surface.vertex_count(); ++v) EXPECT_NEAR(voronoi.distance[v], field.distance[v], 1e-12) << v;
    }
}

TEST(Voronoi, LogMapMatchesTheGeodesicSolver) {
    const Surface surface = rough_ball(9, 0.1);  // irregular: no ties
    const Knots knots = some_knots(surface, 0.05);
    const Voronoi voronoi = geodesic_voronoi(plain_domain(surface), knots);
    std::vector<GeodesicSource> sources;
    for (int v : knots.vertex) sources.push_back({at_vertex(surface, v), 0});
    const GeodesicField field = geodesic_distances(surface, sources);
    for (int v = 0; v < surface.vertex_count(); ++v) {
        EXPECT_EQ(voronoi.cell[v], field.root[v]);
        if (voronoi.distance[v] > 0) {
            EXPECT_NEAR(voronoi.direction[v], field.direction[v], 1e-9) << v;
        }
    }
}

/// The cell of site k in the unit square by half-plane clipping. Each side remembers the site behind it (none: the square's
/// border).
std::vector<std::pair<Eigen::Vector2d, int>> clipped_cell(const std::vector<Eigen::Vector2d>& sites, int k) {
    // corner, site behind the side that starts there
    std::vector<std::pair<Eigen::Vector2d, int>> cell{{{0, 0}, none}, {{1, 0}, none}, {{1, 1}, none}, {{0, 1}, none}};
    for (int other = 0; other < static_cast<int>(sites.size()); ++other) {
        if (other == k)
            continue;
        const Eigen::Vector2d normal = sites[k] - sites[other];
        const double level = (sites[k].squaredNorm() - sites[other].squaredNorm()) / 2;
        const auto inside = [&](const Eigen::Vector2d& p) { return normal.dot(p) - level; };
        std::vector<std::pair<Eigen::Vector2d, int>> next;
        for (std::size_t i = 0; i < cell.size(); ++i) {
            const auto& [p, behind] = cell[i];
            const Eigen::Vector2d q = cell[(i + 1) % cell.size()].first;
            const double a = inside(p), b = inside(q);
            if (a > 0)
                next.push_back({p, behind});
            if (a > 0 && b <= 0)
                next.push_back({p + a / (a - b) * (q - p), other});
            if (a <= 0 && b > 0)
                next.push_back({p + a / (a - b) * (q - p), behind});
        }
        cell = std::move(next);
    }
    return cell;
}

TEST(Voronoi, PlaneAgainstHalfPlaneClipping) {
    const Surface surface = fixtures::irregular_plane(25, 25);
    const Knots knots = some_knots(surface, 0.15);
    const Voronoi voronoi = geodesic_voronoi(plain_domain(surface), knots);
    std::vector<Eigen::Vector2d> sites;
    for (int v : knots.vertex) sites.push_back(surface.point(v).head<2>());
    Weights found = by_pair(voronoi);
    for (int k = 0; k < static_cast<int>(sites.size()); ++k) {
        const auto cell = clipped_cell(sites, k);
        double area = 0;
        for (std::size_t i = 0; i < cell.size(); ++i) {
            const Eigen::Vector2d p = cell[i].first, q = cell[(i + 1) % cell.size()].first;
            area += (p.x() * q.y() - p.y() * q.x()) / 2;
            const int other = cell[i].second;
            if (other < k || (q - p).norm() < 1e-9)
                continue;
            const auto edge = found.find({k, other});
            ASSERT_NE(edge, found.end()) << k << " " << other;
            const double d = (sites[k] - sites[other]).norm();
            EXPECT_NEAR(edge->second.length, (q - p).norm(), 1e-10);
            EXPECT_NEAR(edge->second.distance, d, 1e-10);
            EXPECT_NEAR(edge->second.weight, (q - p).norm() / d, 1e-9);
            found.erase(edge);
        }
        EXPECT_NEAR(voronoi.area[k], area, 1e-12);
    }
    // no invented neighbours
    for (const auto& [pair, edge] : found) EXPECT_LT(edge.length, 1e-8) << pair.first << " " << pair.second;
}

TEST(Voronoi, LinearPrecisionInThePlane) {
    const Surface surface = fixtures::irregular_plane(25, 25);
    const Knots knots = some_knots(surface, 0.2);
    const Voronoi voronoi = geodesic_voronoi(plain_domain(surface), knots);
    std::vector<Eigen::Vector2d> residual(knots.vertex.size(), Eigen::Vector2d::Zero());
    for (const CellEdge& edge : voronoi.edges) {
        const Eigen::Vector2d flux =
            edge.weight * (surface.point(knots.vertex[edge.b]) - surface.point(knots.vertex[edge.a])).head<2>();
        residual[edge.a] += flux;
        residual[edge.b] -= flux;
    }
    std::vector<char> at_border(knots.vertex.size(), 0);
    std::vector<char> border_face(surface.face_count(), 0);
    for (int h = 0; h < surface.halfedge_count(); ++h)
        if (surface.twin(h) == none)
            border_face[h / 3] = 1;
    for (const CellPiece& piece : voronoi.pieces)
        if (border_face[piece.face])
            at_border[piece.cell] = 1;
    int tested = 0;
    for (std::size_t j = 0; j < residual.size(); ++j)
        if (!at_border[j]) {
            EXPECT_LT(residual[j].norm(), 1e-11) << j;  // the divergence theorem, exact for true bisectors
            ++tested;
        }
    EXPECT_GT(tested, 50);
}

/// Squares around every other vertex of a regular grid: bisectors run along mesh edges, four cells meet in each corner.
TEST(Voronoi, RegularGridHasNoTiesTornApart) {
    const int n = 12;
    const Surface surface = fixtures::plane(2 * n, 2 * n);
    std::vector<int> vertices;
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) vertices.push_back(2 * j * (2 * n + 1) + 2 * i);
    const Voronoi voronoi = geodesic_voronoi(plain_domain(surface), knots_at(surface, vertices));
    EXPECT_EQ(voronoi.edges.size(), static_cast<std::size_t>(2 * n * (n + 1)));  // four neighbours, never the diagonal one
    for (const CellEdge& edge : voronoi.edges) {
        const int i = edge.a % (n + 1), j = edge.a / (n + 1);
        const bool along_border = edge.b == edge.a + 1 ? j == 0 || j == n : i == 0 || i == n;
        EXPECT_NEAR(edge.weight, along_border ? 0.5 : 1.0, 1e-12);
        EXPECT_NEAR(edge.distance, 1.0 / n, 1e-14);
    }
}

TEST(Voronoi, IcosahedronsCornersOwnEqualCells) {
    const Surface surface = fixtures::icosphere(12);
    std::vector<int> corners;
    for (int v = 0; v < surface.vertex_count(); ++v) {
        int valence = 0;
        for (int h = 0; h < surface.halfedge_count(); ++h) valence += surface.origin(h) == v;
        if (valence == 5)
            corners.push_back(v);
    }
    ASSERT_EQ(corners.size(), 12u);
    const Voronoi voronoi = geodesic_voronoi(plain_domain(surface), knots_at(surface, corners));
    EXPECT_EQ(voronoi.edges.size(), 30u);
    // coordinates of the fixture are symmetric to rounding
    for (double area : voronoi.area) EXPECT_NEAR(area, surface.area() / 12, 1e-10);
    for (const CellEdge& edge : voronoi.edges) EXPECT_NEAR(edge.weight, voronoi.edges[0].weight, 1e-9);
}

TEST(Voronoi, CellsOfATubeMeetInTwoArcs) {
    const int around = 16, up = 30;
    const double height = 2;
    const Surface surface = fixtures::cylinder(around, up, 1, height);
    const double girth = around * 2 * std::sin(pi / around);
    // Opposite each other at the same height: two vertical arcs, each half a girth of geodesic long.
    const Voronoi sides =
        geodesic_voronoi(plain_domain(surface), knots_at(surface, {up / 2 * around, up / 2 * around + around / 2}));
    ASSERT_EQ(sides.edges.size(), 1u);
    EXPECT_NEAR(sides.edges[0].length, 2 * height, 1e-10);
    EXPECT_NEAR(sides.edges[0].weight, 2 * height / (girth / 2), 1e-10);
    // One above the other: one arc, a whole girth long.
    const Voronoi stacked = geodesic_voronoi(plain_domain(surface), knots_at(surface, {0, up * around}));
    ASSERT_EQ(stacked.edges.size(), 1u);
    EXPECT_NEAR(stacked.edges[0].length, girth, 1e-10);
    EXPECT_NEAR(stacked.edges[0].weight, girth / height, 1e-10);
    EXPECT_NEAR(stacked.area[0], girth * height / 2, 1e-10);
}

TEST(Voronoi, CellsDoNotPassASlit) {
    const int n = 8;
    const Surface surface = fixtures::slit_plane(n);  // y = 1/2 from x = 1/4 to 3/4
    const double reach = 0.2;
    std::vector<int> vertices;
    for (int v = 0; v < surface.vertex_count(); ++v) {
        const Point& p = surface.point(v);
        if (surface.is_border_vertex(v) || std::fmod(p.x() * 8 + 0.1, 1) < 0.2)
            vertices.push_back(v);
    }
    const Knots knots = knots_at(surface, vertices);
    const Voronoi voronoi = geodesic_voronoi(plain_domain(surface), knots);
    const auto middle = [&](int f) {
        return Point((surface.point(surface.face(f)[0]) + surface.point(surface.face(f)[1]) + surface.point(surface.face(f)[2])) /
                     3);
    };
    for (const CellPiece& piece : voronoi.pieces) {
        const Point site = surface.point(knots.vertex[piece.cell]), at = middle(piece.face);
        if (std::abs(at.x() - 0.5) < reach && std::abs(at.y() - 0.5) < 0.1 && std::abs(site.y() - 0.5) > 1e-9) {
            EXPECT_GT((site.y() - 0.5) * (at.y() - 0.5), 0);
        }
    }
    for (const CellEdge& edge : voronoi.edges) {
        const Point a = surface.point(knots.vertex[edge.a]), b = surface.point(knots.vertex[edge.b]);
        if (std::abs(a.x() - 0.5) < reach && std::abs(b.x() - 0.5) < reach) {
            EXPECT_GE((a.y() - 0.5) * (b.y() - 0.5), 0);
        }
        EXPECT_GT((a - b).norm(), 1e-9) << "the two copies of a slit vertex are no neighbours";
    }
}

/// Saddles, reflex corners and hyperbolic bisectors: areas of the pieces of every face against dense sampling with exact
/// distances.
TEST(Voronoi, PiecesAgainstSampledDistances) {
    for (const Surface& surface : {rough_ball(5, 0.15), fixtures::l_shape(4), fixtures::torus(12, 18)}) {
        const Knots knots = some_knots(surface, 0.04, 8);
        const Voronoi voronoi = geodesic_voronoi(plain_domain(surface), knots);
        std::vector<std::vector<std::pair<GeodesicSource, GeodesicField>>> single(knots.vertex.size());
        GeodesicOptions options;
        options.keep_windows = true;
        for (std::size_t k = 0; k < knots.vertex.size(); ++k) {
            const GeodesicSource source{at_vertex(surface, knots.vertex[k]), 0};
            single[k].emplace_back(source, geodesic_distances(surface, std::span(&source, 1), options));
        }
        std::vector<std::vector<double>> exact(surface.face_count(), std::vector<double>(knots.vertex.size(), 0));
        for (const CellPiece& piece : voronoi.pieces) exact[piece.face][piece.cell] = piece.area;
        const int n = 12;
        for (int f = 0; f < surface.face_count(); f += 3) {
            std::vector<double> share(knots.vertex.size(), 0);
            for (int i = 0; i < n; ++i)
                for (int j = 0; i + j < n; ++j)
                    for (int upper = 0; upper < (i + j + 1 < n ? 2 : 1); ++upper) {  // middles of the n^2 small triangles
                        const double u = (i + (upper ? 2.0 : 1.0) / 3) / n, v = (j + (upper ? 2.0 : 1.0) / 3) / n;
                        const SurfacePoint at{f, {1 - u - v, u, v}};
                        std::size_t best = 0;
                        double nearest = 1e300;
                        for (std::size_t k = 0; k < knots.vertex.size(); ++k) {
                            const auto& [source, field] = single[k][0];
                            const double d = distance_at(surface, field, std::span(&source, 1), at);
                            if (d < nearest) {
                                nearest = d;
                                best = k;
                            }
                        }
                        share[best] += 1.0 / (n * n);
                    }
            // A bisector passes about 2 n of the small triangles; half of each is in doubt, with both signs.
            for (std::size_t k = 0; k < share.size(); ++k)
                EXPECT_NEAR(share[k], exact[f][k] / surface.face_area(f), 0.6 / n) << "face " << f << " cell " << k;
        }
    }
}

TEST(Voronoi, RotationScaleAndPermutationChangeNothing) {
    const Surface surface = hills();
    const Knots knots = some_knots(surface, 0.1);
    const Voronoi first = geodesic_voronoi(plain_domain(surface), knots);
    const Weights weights = by_pair(first);

    const Voronoi turned = geodesic_voronoi(plain_domain(fixtures::scaled(fixtures::rotated(surface, 1.1), 3)), knots);
    for (std::size_t j = 0; j < first.area.size(); ++j) EXPECT_NEAR(turned.area[j], 9 * first.area[j], 1e-11);
    EXPECT_EQ(turned.edges.size(), first.edges.size());
    for (const CellEdge& edge : turned.edges) EXPECT_NEAR(edge.weight, weights.at({edge.a, edge.b}).weight, 1e-9);

    const fixtures::Permuted shuffled = fixtures::permuted(surface, 4);
    std::vector<int> vertices;
    for (int v : knots.vertex) vertices.push_back(shuffled.vertex[v]);
    const Knots moved = knots_at(shuffled.surface, vertices);
    const Voronoi second = geodesic_voronoi(plain_domain(shuffled.surface), moved);
    std::vector<int> renamed;
    for (int v : knots.vertex) renamed.push_back(moved.knot_of_vertex[shuffled.vertex[v]]);
    for (std::size_t j = 0; j < first.area.size(); ++j) EXPECT_NEAR(second.area[renamed[j]], first.area[j], 1e-12);
    const Weights other = by_pair(second);
    EXPECT_EQ(other.size(), weights.size());
    for (const auto& [pair, edge] : weights) {
        const auto found = other.find(std::minmax(renamed[pair.first], renamed[pair.second]));
        ASSERT_NE(found, other.end());
        EXPECT_NEAR(found->second.weight, edge.weight, 1e-9);
    }
}

TEST(Voronoi, NeedlesAreNoTrouble) {
    // A plane whose vertices are pressed towards vertical lines: triangles down to 1e-7 of their length in height.
    const Surface flat = fixtures::plane(24, 24);
    for (double pressed : {1e-2, 1e-4, 1e-7}) {
        const Surface surface = fixtures::transformed(flat, [pressed](const Point& p) -> Point {
            const double column = std::floor(p.x() * 8 + 1e-9), rest = p.x() * 8 - column;
            return {(column + (rest < 1e-6 ? 0 : rest < 0.5 ? pressed : 2 * pressed)) / 8, p.y(), 0};
        });
        const Knots knots = some_knots(surface, 0.3);
        const Voronoi voronoi = geodesic_voronoi(plain_domain(surface), knots);
        double sum = 0;
        for (double area : voronoi.area) sum += area;
        EXPECT_NEAR(sum / surface.area(), 1, 1e-10);
        std::vector<Eigen::Vector2d> sites;
        for (int v : knots.vertex) sites.push_back(surface.point(v).head<2>());
        for (int v = 0; v < surface.vertex_count(); ++v) {
            double nearest = 10;
            for (const auto& site : sites) nearest = std::min(nearest, (surface.point(v).head<2>() - site).norm());
            EXPECT_NEAR(voronoi.distance[v], nearest, 1e-10);
        }
    }
}

TEST(Voronoi, ComponentWithoutAKnotIsRefused) {
    const Surface ball = fixtures::icosphere(2);
    std::vector<Point> points = ball.points();
    std::vector<Face> faces = ball.faces();
    for (const Point& p : ball.points()) points.push_back(p + Point(5, 0, 0));
    for (const Face& f : ball.faces())
        faces.push_back({f[0] + ball.vertex_count(), f[1] + ball.vertex_count(), f[2] + ball.vertex_count()});
    const Surface two(points, faces);
    EXPECT_THROW(geodesic_voronoi(plain_domain(two), knots_at(two, {0})), Error);
}

}  // namespace
}  // namespace pvg
