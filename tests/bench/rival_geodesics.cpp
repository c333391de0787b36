// CGAL is slow to compile and stands alone.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_shortest_path.h>

#include "rivals.h"

namespace pvg::bench {

std::vector<double> cgal_distances(const Surface& surface, const std::vector<int>& sources) {
    using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
    using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
    using Paths = CGAL::Surface_mesh_shortest_path<CGAL::Surface_mesh_shortest_path_traits<Kernel, Mesh>>;
    Mesh mesh;
    for (const Point& p : surface.points()) mesh.add_vertex({p.x(), p.y(), p.z()});
    for (const Face& f : surface.faces())
        mesh.add_face(Mesh::Vertex_index(static_cast<unsigned>(f[0])), Mesh::Vertex_index(static_cast<unsigned>(f[1])),
                      Mesh::Vertex_index(static_cast<unsigned>(f[2])));
    Paths paths(mesh);
    for (int v : sources) paths.add_source_point(Mesh::Vertex_index(static_cast<unsigned>(v)));
    paths.build_sequence_tree();
    std::vector<double> distances;
    for (const Mesh::Vertex_index v : mesh.vertices()) distances.push_back(paths.shortest_distance_to_source_points(v).first);
    return distances;
}

}  // namespace pvg::bench
