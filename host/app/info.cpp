// pvg info: what is in a mesh or a scene.
#include <cstdio>
#include <map>

#include "app/verbs.h"
#include "gltf/asset.h"
#include "gltf/describe.h"
#include "mesh/weld.h"
#include "scene/scene.h"

namespace pvg::app {
namespace {

nlohmann::ordered_json mesh_info(const std::filesystem::path& file, const std::optional<std::string>& select,
                                 Warnings& warnings) {
    const MeshAsset asset = MeshAsset::read(file, select, warnings);
    const RawMesh& raw = asset.mesh();
    const WeldedMesh welded = weld(raw.points, raw.faces, warnings);
    const Surface& surface = welded.surface;
    int components = 0;
    face_components(surface, &components);
    int border = 0, edges = 0, used = 0;
    double shortest = 0, longest = 0;
    for (int h = 0; h < surface.halfedge_count(); ++h) {
        const int twin = surface.twin(h);
        if (twin != none && twin < h)
            continue;
        const double length = surface.length(h);
        shortest = edges == 0 ? length : std::min(shortest, length);
        longest = std::max(longest, length);
        ++edges;
        if (twin == none)
            ++border;
    }
    for (int v = 0; v < surface.vertex_count(); ++v) used += surface.outgoing(v) != none ? 1 : 0;
    return {{"mesh", raw.name},
            {"vertices", raw.points.size()},
            {"triangles", raw.faces.size()},
            {"welded",
             {{"vertices", used},
              {"triangles", surface.face_count()},
              {"edges", edges},
              {"border_edges", border},
              {"non_manifold_edges", welded.non_manifold_edges.size()}}},
            {"components", components},
            {"euler_characteristic", used - edges + surface.face_count()},
            {"area", surface.area()},
            {"diagonal", surface.diagonal()},
            {"edge_length", {{"shortest", shortest}, {"longest", longest}}},
            {"scene_inside", asset.embedded_scene().has_value()}};
}

/// What the file holds; the surface too where there is only one mesh to choose, else a surface a mesh.
nlohmann::ordered_json file_info(const std::filesystem::path& file, Warnings& warnings) {
    nlohmann::ordered_json result = describe_mesh_file(file, warnings);
    const bool one = result["meshes"].size() == 1;
    for (std::size_t m = 0; m < result["meshes"].size(); ++m) {
        if (result["meshes"][m]["triangles"] == 0)
            continue;
        const nlohmann::ordered_json surface = mesh_info(file, std::to_string(m), warnings);
        if (one)
            result.update(surface);
        else
            result["meshes"][m]["surface"] = surface;
    }
    return result;
}

nlohmann::ordered_json scene_info(const std::filesystem::path& file, Warnings& warnings) {
    const Scene scene = read_scene(file);
    std::map<std::string, int> kinds;
    int disabled = 0;
    for (const Layer& layer : scene.layers)
        for (const Primitive& primitive : layer.primitives) {
            static constexpr const char* names[] = {"diffusion_curve", "poisson_curve", "poisson_region"};
            ++kinds[names[primitive.shape.index()]];
            if (!primitive.enabled)
                ++disabled;
        }
    nlohmann::ordered_json result = {{"scene", file.string()},
                                     {"layers", scene.layers.size()},
                                     {"primitives", kinds},
                                     {"disabled", disabled},
                                     {"mesh_file", scene.mesh_file.string()}};
    result["surface"] = mesh_info(scene.mesh_file, scene.mesh_select, warnings);
    return result;
}

void print_table(const nlohmann::ordered_json& value, int indent) {
    for (const auto& [key, entry] : value.items()) {
        const bool list_of_objects = entry.is_array() && !entry.empty() && entry[0].is_object();
        if (entry.is_object() || list_of_objects) {
            std::printf("%*s%s\n", indent, "", key.c_str());
            print_table(entry, indent + 2);
        } else {
            std::printf("%*s%-*s %s\n", indent, "", 24 - indent, key.c_str(),
                        entry.is_string() ? entry.get<std::string>().c_str() : entry.dump().c_str());
        }
    }
}

}  // namespace

int info(const InfoOptions& options, Console& console) {
    Warnings warnings;
    const nlohmann::ordered_json result =
        options.file.extension() == ".json" ? scene_info(options.file, warnings) : file_info(options.file, warnings);
    if (options.json)
        std::printf("%s\n", result.dump(2).c_str());
    else
        print_table(result, 0);
    console.warn(warnings);
    return 0;
}

}  // namespace pvg::app
