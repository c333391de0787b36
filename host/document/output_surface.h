// What a build looks like from outside: faces, and where each output vertex finds its colours.
#pragma once

#include "pvg/scene_document.h"
#include "scene/scene.h"
#include "solve/build.h"

namespace pvg {

OutputSurface output_surface(const Scene& scene, const Build& build);

/// The words of a scene file.
const char* word(ColorSpace space);
const char* word(BlendMode mode);

}  // namespace pvg
