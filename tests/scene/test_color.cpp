// Laws of the colour spaces and of compositing, and published values.
#include <cmath>

#include <gtest/gtest.h>

#include "scene/color.h"

namespace pvg {
namespace {

TEST(Srgb, IsTheStandardsCurve) {
    EXPECT_EQ(srgb_from_linear(0), 0);
    EXPECT_NEAR(srgb_from_linear(1), 1, 1e-15);
    EXPECT_NEAR(linear_from_srgb(0.5), 0.21404114048223255, 1e-15);  // IEC 61966-2-1
    EXPECT_NEAR(linear_from_srgb(0.04045), 0.04045 / 12.92, 1e-15);
}

TEST(Srgb, IsOddAndItsOwnInverse) {
    for (double v = -2; v <= 2; v += 0.0173) {
        EXPECT_EQ(srgb_from_linear(-v), -srgb_from_linear(v));
        EXPECT_EQ(linear_from_srgb(-v), -linear_from_srgb(v));
        // The standard's two branches meet within 3e-8, no better.
        EXPECT_NEAR(linear_from_srgb(srgb_from_linear(v)), v, 1e-7);
    }
}

TEST(Oklab, MeetsPublishedValues) {
    // Ottosson 2020: white is (1, 0, 0); red from the reference implementation. The published matrices have ten digits.
    const Color white = to_diffusion_space({1, 1, 1, 1}, ColorSpace::oklab);
    EXPECT_NEAR((white - Color(1, 0, 0, 1)).norm(), 0, 1e-6);
    const Color red = to_diffusion_space({1, 0, 0, 1}, ColorSpace::oklab);
    EXPECT_NEAR((red - Color(0.6279554, 0.2248631, 0.1258463, 1)).norm(), 0, 1e-6);
}

TEST(DiffusionSpace, GoesThereAndBack) {
    for (const ColorSpace space : {ColorSpace::linear, ColorSpace::srgb, ColorSpace::oklab}) {
        for (const Color& color : {Color(0, 0, 0, 0), Color(1, 1, 1, 1), Color(0.2, 0.7, 0.1, 0.4), Color(-0.1, 1.3, 0.5, 1)}) {
            const Color back = from_diffusion_space(to_diffusion_space(color, space), space);
            EXPECT_NEAR((back - color).norm(), 0, 1e-7);
            EXPECT_EQ(back[3], color[3]);
        }
    }
    EXPECT_EQ(to_diffusion_space({0.1, 0.2, 0.3, 0.4}, ColorSpace::linear), Color(0.1, 0.2, 0.3, 0.4));
}

TEST(Blend, OpaqueOverHidesAndClearOverShows) {
    const Color under(0.2, 0.4, 0.6, 0.5);
    EXPECT_NEAR((blend_colors(under, {0.9, 0.1, 0.3, 1}, BlendMode::over) - Color(0.9, 0.1, 0.3, 1)).norm(), 0, 1e-15);
    for (const BlendMode mode : {BlendMode::over, BlendMode::multiply, BlendMode::add}) {
        EXPECT_NEAR((blend_colors(under, {0.9, 0.1, 0.3, 0}, mode) - under).norm(), 0, 1e-15);
        // On nothing every mode paints the colour itself.
        EXPECT_NEAR((blend_colors({0, 0, 0, 0}, {0.9, 0.1, 0.3, 0.5}, mode) - Color(0.9, 0.1, 0.3, 0.5)).norm(), 0, 1e-15);
        EXPECT_EQ(blend_colors({1, 1, 1, 0}, {1, 1, 1, 0}, mode), Color(0, 0, 0, 0));
    }
}

TEST(Blend, IsTheFormulaOnOpaqueGround) {
    const Color under(0.2, 0.4, 0.6, 1), over(0.5, 0.25, 1, 0.5);
    EXPECT_NEAR((blend_colors(under, over, BlendMode::over) - Color(0.35, 0.325, 0.8, 1)).norm(), 0, 1e-15);
    EXPECT_NEAR((blend_colors(under, over, BlendMode::multiply) - Color(0.15, 0.25, 0.6, 1)).norm(), 0, 1e-15);
    EXPECT_NEAR((blend_colors(under, over, BlendMode::add) - Color(0.45, 0.525, 1.1, 1)).norm(), 0, 1e-15);
}

TEST(Blend, OverIsAssociative) {
    const Color a(0.1, 0.9, 0.3, 0.7), b(0.8, 0.2, 0.5, 0.4), c(0.3, 0.3, 1, 0.6);
    const Color first = blend_colors(blend_colors(a, b, BlendMode::over), c, BlendMode::over);
    const Color second = blend_colors(a, blend_colors(b, c, BlendMode::over), BlendMode::over);
    EXPECT_NEAR((first - second).norm(), 0, 1e-15);
}

}  // namespace
}  // namespace pvg
