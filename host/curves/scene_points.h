// Scene points as points on the surface that curves are drawn on.
#pragma once

#include <string>
#include <vector>

#include "curves/arrangement.h"
#include "curves/snap.h"
#include "scene/scene.h"

namespace pvg {

class ScenePoints {
public:
    /// base must outlive it.
    ScenePoints(const Scene& scene, const BaseSurface& base);

    /// Positions snap to the closest point, face coordinates of the file's mesh are carried over. Throws Error(bad_input) "FILE:
    /// POINTER: ..." when the point is farther than 5 % of the diagonal (unless snap_any) or its face is not there.
    SurfacePoint resolve(const ScenePoint& point, bool snap_any) const;
    SurfacePoint closest(const Point& position) const { return tree_.closest(position).at; }

private:
    SurfacePoint on_raw_face(const ScenePoint& point) const;

    std::string file_;
    const BaseSurface& base_;
    ClosestPointTree tree_;
    double reach_ = 0;
    std::vector<std::vector<int>> base_faces_;  // per welded face
};

}  // namespace pvg
