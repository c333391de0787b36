// How far two evaluators agree, and how far one may be off.
//
// The kernels use only additions, subtractions and multiplications in a fixed order. A device that rounds them to nearest and
// keeps subnormals gives the CPU's bits; lavapipe and every desktop GPU do the former. Vulkan lets a device round a sum or a
// product to either neighbour and flush subnormals. Hence the stated bound for devices without the guarantee, stage by stage,
// each against exact arithmetic on the numbers that the stage read on that device, u = 2^-23:
//   value     (L + 1) u sum |weight x coefficient| + (L + 1) 2^-126, L the padded list's length
//   height    T u sum |term|, T the vertex's terms;   position  3 u (|base| + |height x unit|) a coordinate
//   normal    24 u (1 + sum 1 / (|d| |e|) / |sum cross(d, e) / (|d|^2 |e|^2)|) a coordinate, d and e a corner's edges
#pragma once

#include <string>

#include "pvg/program.h"

namespace pvg {

struct Agreement {
    bool bit_identical = false;
    double max_ulp = 0;  ///< most floats that lie between two numbers that should be equal (-0 and 0 are one)
};

/// Requires two evaluations of one program; arrays of different sizes give an infinite max_ulp.
Agreement compare_evaluations(const Evaluation& a, const Evaluation& b);

/// Empty when every number is within the bound above, else the first that is not, in words. Requires validate(program).
std::string first_beyond_bound(const Program& program, const Evaluation& evaluation);

}  // namespace pvg
