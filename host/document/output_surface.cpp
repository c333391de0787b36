#include "document/output_surface.h"

namespace pvg {

const char* word(ColorSpace space) {
    return space == ColorSpace::linear ? "linear" : space == ColorSpace::srgb ? "srgb" : "oklab";
}

const char* word(BlendMode mode) { return mode == BlendMode::over ? "over" : mode == BlendMode::multiply ? "multiply" : "add"; }

OutputSurface output_surface(const Scene& scene, const Build& build) {
    const Arrangement& arrangement = build.arrangement;
    const auto unsign = [](const Face& face) {
        std::array<std::uint32_t, 3> corners;
        for (int k = 0; k < 3; ++k) corners[k] = face[k] == none ? OutputSurface::no_row : static_cast<std::uint32_t>(face[k]);
        return corners;
    };
    OutputSurface output;
    for (const Face& face : arrangement.output.faces()) output.faces.push_back(unsign(face));
    for (const Face& face : build.corner_normal) output.corner_normal.push_back(unsign(face));
    for (std::size_t l = 0; l < arrangement.layers.size(); ++l) {
        const LayerFields& fields = arrangement.layers[l];
        if (fields.color_domain == none)
            continue;
        const Table& table = build.program.fields[fields.color_domain].table;
        OutputSurface::ColorLayer& layer = output.color_layers.emplace_back();
        layer.field = static_cast<std::uint32_t>(fields.color_domain);
        layer.channel = static_cast<std::uint32_t>(fields.color_channel);
        layer.blend = word(scene.layers[l].blend);
        for (int vertex : arrangement.domain_vertex[fields.color_domain])
            layer.row.push_back(vertex == none ? OutputSurface::no_row : table.vertex_row[vertex]);
    }
    output.color_space = word(scene.color_space);
    return output;
}

}  // namespace pvg
