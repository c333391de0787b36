#include "mesh/surface_map.h"

#include <algorithm>

namespace pvg {

SurfaceMap identity_map(const Surface& surface) {
    SurfaceMap map;
    map.vertex.resize(surface.vertex_count());
    for (int v = 0; v < surface.vertex_count(); ++v) map.vertex[v].vertex[0] = v;
    map.face.resize(surface.face_count());
    for (int f = 0; f < surface.face_count(); ++f) map.face[f] = f;
    return map;
}

SurfaceMap compose(const SurfaceMap& first, const SurfaceMap& second) {
    SurfaceMap map;
    map.face.reserve(second.face.size());
    for (int f : second.face) map.face.push_back(first.face[f]);
    map.vertex.reserve(second.vertex.size());
    for (const VertexOrigin& origin : second.vertex) {
        if (origin.is_vertex()) {
            map.vertex.push_back(first.vertex[origin.vertex[0]]);
            continue;
        }
        // All grandparents lie on one face, so at most three are different.
        VertexOrigin sum{{none, none, none}, {0, 0, 0}};
        for (int i = 0; i < 3 && origin.vertex[i] != none; ++i) {
            const VertexOrigin& parent = first.vertex[origin.vertex[i]];
            for (int j = 0; j < 3 && parent.vertex[j] != none; ++j) {
                int slot = 0;
                while (sum.vertex[slot] != none && sum.vertex[slot] != parent.vertex[j]) ++slot;
                sum.vertex[slot] = parent.vertex[j];
                sum.weight[slot] += origin.weight[i] * parent.weight[j];
            }
        }
        map.vertex.push_back(sum);
    }
    return map;
}

}  // namespace pvg
