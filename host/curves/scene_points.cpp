#include "curves/scene_points.h"

#include <algorithm>
#include <cstdio>

#include "pvg/status.h"

namespace pvg {
namespace {

constexpr double snap_share = 0.05;  // of the diagonal

}  // namespace

ScenePoints::ScenePoints(const Scene& scene, const BaseSurface& base)
    : file_(scene.file.string()),
      base_(base),
      tree_(base.surface),
      reach_(snap_share * base.welded.diagonal()),
      base_faces_(base.welded.face_count()) {
    for (int f = 0; f < base.surface.face_count(); ++f) base_faces_[base.map.face[f]].push_back(f);
}

SurfacePoint ScenePoints::resolve(const ScenePoint& point, bool snap_any) const {
    if (point.on_face)
        return on_raw_face(point);
    const ClosestPoint found = tree_.closest(point.position);
    if (!snap_any && found.distance > reach_) {
        char text[192];
        std::snprintf(text, sizeof text,
                      "expected a point within %.4g of the surface (5 %% of its diagonal) or \"snap\": \"any\", found [%.6g, "
                      "%.6g, %.6g], %.4g away",
                      reach_, point.position[0], point.position[1], point.position[2], found.distance);
        throw Error(ErrorKind::bad_input, file_ + ": " + point.pointer + ": " + text);
    }
    return found.at;
}

SurfacePoint ScenePoints::on_raw_face(const ScenePoint& point) const {
    const auto found = std::lower_bound(base_.face_raw.begin(), base_.face_raw.end(), point.face);
    if (found == base_.face_raw.end() || *found != point.face)
        throw Error(ErrorKind::bad_input, file_ + ": " + point.pointer +
                                              ": expected a triangle of the mesh that has an area (the last one is " +
                                              std::to_string(base_.face_raw.empty() ? -1 : base_.face_raw.back()) + "), found " +
                                              std::to_string(point.face));
    const int welded_face = static_cast<int>(found - base_.face_raw.begin());
    const Face& corners = base_.welded.face(welded_face);
    // Of the base faces inside this one, the one in which the point's coordinates are least negative.
    SurfacePoint best;
    double least = 0;
    for (int f : base_faces_[welded_face]) {
        Eigen::Matrix3d own;  // columns: the base face's corners in coordinates of the welded face
        own.setZero();
        for (int k = 0; k < 3; ++k) {
            const VertexOrigin& origin = base_.map.vertex[base_.surface.face(f)[k]];
            for (int i = 0; i < 3 && origin.vertex[i] != none; ++i)
                for (int c = 0; c < 3; ++c)
                    if (corners[c] == origin.vertex[i])
                        own(c, k) += origin.weight[i];
        }
        Eigen::Vector3d bary = own.inverse() * point.bary;
        if (!bary.allFinite())
            continue;
        if (best.face == none || bary.minCoeff() > least) {
            least = bary.minCoeff();
            best = {f, bary};
        }
    }
    if (best.face == none)
        throw Error(ErrorKind::bad_input,
                    file_ + ": " + point.pointer + ": triangle " + std::to_string(point.face) + " has no area");
    best.bary = best.bary.cwiseMax(0.0);
    best.bary /= best.bary.sum();
    return best;
}

}  // namespace pvg
