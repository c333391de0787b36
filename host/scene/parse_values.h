// The parts a primitive is made of, read from the scene's JSON: colours, values along a curve, points, paths.
#pragma once

#include "scene/json_node.h"
#include "scene/scene.h"

namespace pvg {

/// "#rrggbb", "#rrggbbaa" (sRGB) or [r, g, b(, a)] (linear) as linear RGBA.
Color parse_color(const JsonNode& node);
/// [r, g, b]: a difference in the space of diffusion, alpha 0.
Eigen::Vector4d parse_color_difference(const JsonNode& node);
double parse_height(const JsonNode& node);

/// A side of a diffusion curve or the jump of a Poisson curve: one object of color and height, or a list of stops.
SideValues parse_side(const JsonNode& node);
struct JumpValues {
    Stops<Eigen::Vector4d> color;
    Stops<double> height;
};
JumpValues parse_jump(const JsonNode& node);

ScenePoint parse_point(const JsonNode& node);
/// must_close: the path of a region.
ScenePath parse_path(const JsonNode& node, bool must_close);

}  // namespace pvg
