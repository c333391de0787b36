// OKLab: B. Ottosson, "A perceptual color space for image processing" (2020). Compositing: W3C "Compositing and Blending
// Level 1", general formula with straight alpha.
#include "scene/color.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

namespace pvg {
namespace {

const Eigen::Matrix3d& lms_from_linear() {
    static const Eigen::Matrix3d M = (Eigen::Matrix3d() << 0.4122214708, 0.5363325363, 0.0514459929,  //
                                      0.2119034982, 0.6806995451, 0.1073969566,                       //
                                      0.0883024619, 0.2817188376, 0.6299787005)
                                         .finished();
    return M;
}

const Eigen::Matrix3d& oklab_from_lms() {
    static const Eigen::Matrix3d M = (Eigen::Matrix3d() << 0.2104542553, 0.7936177850, -0.0040720468,  //
                                      1.9779984951, -2.4285922050, 0.4505937099,                       //
                                      0.0259040371, 0.7827717662, -0.8086757660)
                                         .finished();
    return M;
}

}  // namespace

double srgb_from_linear(double value) {
    const double size = std::abs(value);
    const double coded = size <= 0.0031308 ? 12.92 * size : 1.055 * std::pow(size, 1 / 2.4) - 0.055;
    return std::copysign(coded, value);
}

double linear_from_srgb(double value) {
    const double size = std::abs(value);
    const double linear = size <= 0.04045 ? size / 12.92 : std::pow((size + 0.055) / 1.055, 2.4);
    return std::copysign(linear, value);
}

Color to_diffusion_space(const Color& linear, ColorSpace space) {
    Color result = linear;
    if (space == ColorSpace::srgb) {
        for (int c = 0; c < 3; ++c) result[c] = srgb_from_linear(linear[c]);
    } else if (space == ColorSpace::oklab) {
        const Eigen::Vector3d lms = lms_from_linear() * linear.head<3>();
        result.head<3>() = oklab_from_lms() * lms.unaryExpr([](double v) { return std::cbrt(v); });
    }
    return result;
}

Color from_diffusion_space(const Color& diffused, ColorSpace space) {
    Color result = diffused;
    if (space == ColorSpace::srgb) {
        for (int c = 0; c < 3; ++c) result[c] = linear_from_srgb(diffused[c]);
    } else if (space == ColorSpace::oklab) {
        // The inverses of the two matrices above, not the rounded ones of the publication, so that a round trip is exact to
        // rounding.
        static const Eigen::Matrix3d lms_from_oklab = oklab_from_lms().inverse();
        static const Eigen::Matrix3d linear_from_lms = lms_from_linear().inverse();
        const Eigen::Vector3d lms = lms_from_oklab * diffused.head<3>();
        result.head<3>() = linear_from_lms * lms.unaryExpr([](double v) { return v * v * v; });
    }
    return result;
}

Color blend_colors(const Color& under, const Color& over, BlendMode mode) {
    const double above = std::clamp(over[3], 0.0, 1.0);
    const double below = std::clamp(under[3], 0.0, 1.0);
    const double alpha = above + below * (1 - above);
    Color result = Color::Zero();
    if (alpha <= 0)
        return result;
    for (int c = 0; c < 3; ++c) {
        double mixed = over[c];
        if (mode == BlendMode::multiply)
            mixed = under[c] * over[c];
        if (mode == BlendMode::add)
            mixed = under[c] + over[c];
        result[c] = (above * (1 - below) * over[c] + above * below * mixed + (1 - above) * below * under[c]) / alpha;
    }
    result[3] = alpha;
    return result;
}

}  // namespace pvg
