// From evaluated fields to the mesh that is written: layers blended, walls raised.
#pragma once

#include "gltf/asset.h"
#include "pvg/program.h"
#include "solve/build.h"

namespace pvg::app {

struct ComposeOptions {
    bool displace = true;  ///< false: --no-displace; the program was then evaluated with unit 0
};

DecoratedMesh compose(const Scene& scene, const RawMesh& raw, const Build& build, const Evaluation& evaluation,
                      const ComposeOptions& options);

}  // namespace pvg::app
