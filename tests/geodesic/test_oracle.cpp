// Against CGAL's Surface_mesh_shortest_path: the same algorithm, written by others.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_shortest_path.h>

#include "fixtures/meshes.h"
#include "geodesic/checks.h"

namespace pvg {
namespace {

using namespace fixtures;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Oracle = CGAL::Surface_mesh_shortest_path<CGAL::Surface_mesh_shortest_path_traits<Kernel, Mesh>>;

// Both unfold in double; 1e-6 leaves room for CGAL's own handling of nearly flat vertices.
constexpr double tolerance = 1e-6;

void compare(const char* name, const Surface& surface, const std::vector<int>& from) {
    Mesh mesh;
    for (const Point& p : surface.points()) mesh.add_vertex({p.x(), p.y(), p.z()});
    for (const Face& f : surface.faces())
        mesh.add_face(Mesh::Vertex_index(f[0]), Mesh::Vertex_index(f[1]), Mesh::Vertex_index(f[2]));
    std::vector<GeodesicSource> sources;
    for (int v : from) sources.push_back({at_vertex(surface, v), 0});

    double start = checks::cpu_seconds();
    const GeodesicField field = geodesic_distances(surface, sources);
    const double ours = checks::cpu_seconds() - start;

    start = checks::cpu_seconds();
    Oracle oracle(mesh);
    for (int v : from) oracle.add_source_point(Mesh::Vertex_index(v));
    oracle.build_sequence_tree();
    std::vector<double> expected;
    for (const Mesh::Vertex_index v : mesh.vertices()) expected.push_back(oracle.shortest_distance_to_source_points(v).first);
    const double theirs = checks::cpu_seconds() - start;

    double worst = 0;
    for (int v = 0; v < surface.vertex_count(); ++v)
        worst = std::max(worst, std::abs(field.distance[v] - expected[v]) / (expected[v] + 1e-12));
    EXPECT_LT(worst, tolerance) << name;
    std::printf("%s: %d vertices, %zu sources, CPU %.3f s, CGAL %.3f s (%.1f times), largest relative difference %.2g\n", name,
                surface.vertex_count(), from.size(), ours, theirs, theirs / ours, worst);
    EXPECT_LT(ours, theirs) << name;

    // Inside faces.
    const GeodesicField kept = checks::field_of(surface, sources);
    Random random(12);
    for (int i = 0; i < 200; ++i) {
        SurfacePoint at{random.below(surface.face_count()), {random.real(), random.real(), random.real()}};
        at.bary /= at.bary.sum();
        const auto h = mesh.halfedge(Mesh::Face_index(at.face));
        Oracle::Barycentric_coordinates bary;
        for (int k = 0; k < 3; ++k) {  // CGAL's order begins at the source of the face's halfedge
            auto g = h;
            for (int turn = 0; turn < k; ++turn) g = mesh.next(g);
            const int v = static_cast<int>(mesh.source(g));
            for (int j = 0; j < 3; ++j)
                if (surface.face(at.face)[j] == v)
                    bary[k] = at.bary[j];
        }
        const double d = oracle.shortest_distance_to_source_points(Mesh::Face_index(at.face), bary).first;
        EXPECT_NEAR(distance_at(surface, kept, sources, at), d, tolerance * d) << name;
    }
}

TEST(GeodesicOracle, Sphere) { compare("sphere", icosphere(24), {100}); }

TEST(GeodesicOracle, Torus) { compare("torus", torus(60, 30), {7, 900}); }

TEST(GeodesicOracle, BumpsWithSlits) {
    // Half of its vertices are saddles; the slits' tips and corners bend paths too.
    const Surface flat =
        lifted(irregular_plane(50, 50), [](double x, double y) { return 0.06 * std::sin(25 * x) * std::cos(21 * y); });
    std::vector<int> slit;  // a chain of edges, as it comes
    int v = 25 * 51 + 12;
    while (slit.size() < 20) {
        slit.push_back(v);
        int best = none;
        for (int w = 0; w < flat.vertex_count(); ++w)
            if (flat.halfedge_between(v, w) != none && (best == none || flat.point(w).x() > flat.point(best).x()))
                best = w;
        v = best;
    }
    compare("bumps", cut_open(flat, {slit}), {51 * 10 + 20, 51 * 40 + 30, 300});
}

}  // namespace
}  // namespace pvg
