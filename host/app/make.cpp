// pvg make: a procedural mesh as .glb.
#include "app/verbs.h"
#include "gltf/import_mesh.h"
#include "mesh/shapes.h"

namespace pvg::app {

int make(const MakeOptions& options, Console& console) {
    const ShapeMesh mesh = make_shape(options.shape, options.vertices);
    write_glb(options.out, mesh, options.shape);
    console.say(options.out.string() + ": " + options.shape + ", " + std::to_string(mesh.points.size()) +
                " vertices with seams, " + std::to_string(mesh.faces.size()) + " triangles");
    return 0;
}

}  // namespace pvg::app
