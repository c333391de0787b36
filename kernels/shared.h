// What the host and the shaders agree on: bindings, the ranges a dispatch covers, and the arithmetic of unit vectors.
// Compiled as C++ and as GLSL.
//
// Only additions, subtractions, multiplications, comparisons and integer operations are used in the kernels: they are
// correctly rounded on every conforming device, so a device that rounds to nearest and is told not to contract (`precise`)
// gives the bits of the CPU twin. Division, sqrt() and inversesqrt() are not exact in Vulkan; dot(), cross(), length() have no
// fixed order; fma() may or may not be fused. Subnormal results may be flushed by a device: the thresholds below keep
// intermediate values of unit vectors away from them.
#ifndef PVG_KERNELS_SHARED_H
#define PVG_KERNELS_SHARED_H

#ifdef __cplusplus
#include <bit>
#include <cstdint>
#define PVG_FUNCTION inline
#define PVG_PRECISE
#define PVG_BITS(x) std::bit_cast<std::uint32_t>(x)
#define PVG_FLOAT(x) std::bit_cast<float>(x)
namespace pvg::kernels {
using uint = std::uint32_t;
#else
#define PVG_FUNCTION
#define PVG_PRECISE precise
#define PVG_BITS(x) floatBitsToUint(x)
#define PVG_FLOAT(x) uintBitsToFloat(x)
#endif

#define PVG_LOCAL_SIZE 64

// Bindings of set 0. Inputs are texel buffers, or storage buffers where a device's texel buffers are too small.
#define PVG_EVALUATE_ROWS 0     // per row: first index / 4, first weight / 4, list length / 4, unused
#define PVG_EVALUATE_INDICES 1  // four a texel
#define PVG_EVALUATE_WEIGHTS 2  // four a texel
#define PVG_EVALUATE_COLORS 3   // coefficients of the first four channels (4 or 5 channels)
#define PVG_EVALUATE_SCALARS 4  // coefficients of the last channel (1 or 5 channels)
#define PVG_EVALUATE_VALUES 5   // out: rows x channels
#define PVG_EVALUATE_BINDINGS 6

#define PVG_DISPLACE_BASE 0    // xyz, 0
#define PVG_DISPLACE_NORMAL 1  // xyz, 0
#define PVG_DISPLACE_FIRST 2   // first height term of each vertex, one more at the end
#define PVG_DISPLACE_TERMS 3   // field, row * channels + channel
#define PVG_DISPLACE_VALUES 4  // values of one field
#define PVG_DISPLACE_POSITIONS 5  // in and out: displaced xyz, height
#define PVG_DISPLACE_BINDINGS 6

#define PVG_NORMALS_FIRST 0      // first corner of each shading normal, one more at the end
#define PVG_NORMALS_CORNERS 1    // a, b, c, 0
#define PVG_NORMALS_POSITIONS 2  // xyz, height
#define PVG_NORMALS_NORMALS 3    // out: xyz, 0
#define PVG_NORMALS_BINDINGS 4

// Push constants. Every dispatch covers a range that the device's limits allow; the bindings start at the range, and
// what an array stores as an absolute position is made relative by its base.
struct EvaluateRange {
    uint row_count;
    uint index_base;   // in texels of four
    uint weight_base;  // in texels of four
};

struct DisplaceRange {
    uint vertex_count;
    uint term_base;
    uint field;       // only terms of this field are added
    uint term_first;  // and only terms number first .. last - 1 of a vertex
    uint term_last;
    uint start;       // 1: heights start at 0, 0: they continue from the pass before
    float unit;
};

struct NormalsRange {
    uint normal_count;
    uint corner_base;
};

// 1 / sqrt(x) for x in [1e-36, 1e36], to about 1.5 ulp: the exponent trick's 3.4 % after four Newton steps.
// Source: C. Lomont, "Fast inverse square root", 2003 (the constant).
PVG_FUNCTION float inverse_square_root(float x) {
    PVG_PRECISE float y = PVG_FLOAT(0x5f375a86u - (PVG_BITS(x) >> 1));
    PVG_PRECISE float half_x = 0.5f * x;
    for (int step = 0; step < 4; ++step) {
        PVG_PRECISE float t = half_x * y;
        t = t * y;
        t = 1.5f - t;
        y = y * t;
    }
    return y;
}

// Squared lengths of edges that count in a normal; outside them a corner has no area.
#define PVG_EDGE_MIN 1e-34f
#define PVG_EDGE_MAX 1e34f
// Sine of a corner's angle below which its cross product is rounding noise.
#define PVG_SINE_MIN 2.384185791015625e-7f
// A sum of corners smaller than this is no direction.
#define PVG_SUM_MIN 7.888609052210118e-31f

// 2^-e for x = m 2^e, 1 <= m < 2, x in [2^-100, 2^126].
PVG_FUNCTION float inverse_power_of_two(float x) { return PVG_FLOAT(0x7f000000u - (PVG_BITS(x) & 0x7f800000u)); }

#ifdef __cplusplus
}  // namespace pvg::kernels
#endif

#undef PVG_BITS
#undef PVG_FLOAT
#undef PVG_FUNCTION
#endif  // PVG_KERNELS_SHARED_H
