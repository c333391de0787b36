#include "curves/arrangement.h"

#include <utility>

#include "curves/drawing.h"

namespace pvg {

double length_unit(const Scene& scene, const Surface& welded) { return scene.unit_is_bbox ? welded.diagonal() : 1.0; }

Arrangement arrange(const Scene& scene, const BaseSurface& base, Warnings& warnings) {
    Drawing drawing = draw(scene, base, length_unit(scene, base.welded));
    return arrange_drawing(scene, base.surface, std::move(drawing), warnings);
}

}  // namespace pvg
