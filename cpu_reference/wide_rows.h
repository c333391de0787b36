// Rows of one cell, eight at a time, for processors with AVX2: each lane is a row with its own sum in list order, multiplied
// and added without contraction, so that the bits are those of one row at a time.
#pragma once

#include <cstddef>
#include <cstdint>

namespace pvg {

/// Whether this processor can run evaluate_rows_wide().
bool wide_rows_supported();

/// count rows of one cell. local: the list's coefficients, stride x channels (1, 4 or 5) in list order; weights: count x stride,
/// stride a multiple of 4; values: count x channels. Requires wide_rows_supported().
void evaluate_rows_wide(int channels, const float* local, std::size_t stride, const float* weights, std::size_t count,
                        float* values);

}  // namespace pvg
