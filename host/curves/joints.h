// Where open curves end on other curves. Imprinting moves a curve by up to 0.05 edges (it snaps to vertices), so that an end that
// was drawn on another curve may miss it by as much; across the gap values would leak. Here ends are moved onto what they meet.
#pragma once

#include <array>
#include <unordered_map>
#include <vector>

#include "curves/curve_path.h"
#include "curves/imprint.h"

namespace pvg {

/// The curves imprinted so far that may be met. "Near" is within 0.1 x the mean edge length of the point's face, over the
/// surface.
class Joints {
public:
    /// surface: what curves are drawn on; must outlive it.
    explicit Joints(const Surface& surface) : surface_(&surface) {}

    /// To be called before a path is imprinted. Each end of an open path goes to the nearest tip that is near (an earlier
    /// curve's, or for the last point the path's own first), else to the nearest point of an earlier curve, of the border or of
    /// the path's own other parts that is near. Then the path is led through all earlier tips near it that ended nowhere. Other
    /// ends stay where they are. Returns whether the first and the last point meet something.
    std::array<bool, 2> join(SampledCurve& curve) const;

    /// Remembers a curve after it was imprinted. met: what join() returned for it.
    void add(const Imprinter& imprinter, const CurveChain& chain, std::array<bool, 2> met);

private:
    struct Piece {
        Eigen::Vector3d from, to;  ///< coordinates in the face
    };
    double reach(const SurfacePoint& at) const;
    std::vector<int> faces_near(const SurfacePoint& at, double radius) const;
    bool meet(SampledCurve& curve, bool at_end) const;
    void pass_through_tips(SampledCurve& curve) const;

    const Surface* surface_;
    std::unordered_map<int, std::vector<Piece>> pieces_;  ///< per face: what lies in it
    std::vector<SurfacePoint> tips_;
    std::vector<char> loose_;                              ///< per tip: it meets nothing
    std::unordered_map<int, std::vector<int>> tips_near_;  ///< per face: tips near it
};

}  // namespace pvg
