// Colour spaces of diffusion. Colours in scenes and files are linear sRGB primaries, straight alpha.
#pragma once

#include "scene/scene.h"

namespace pvg {

/// sRGB transfer function, one channel, extended oddly to negative numbers.
double srgb_from_linear(double value);
double linear_from_srgb(double value);

/// From linear RGBA into the space of diffusion and back (alpha unchanged). OKLab after B. Ottosson (2020).
Color to_diffusion_space(const Color& linear, ColorSpace space);
Color from_diffusion_space(const Color& diffused, ColorSpace space);

/// `over` composited over `under` (straight alpha).
Color blend_colors(const Color& under, const Color& over, BlendMode mode);

}  // namespace pvg
