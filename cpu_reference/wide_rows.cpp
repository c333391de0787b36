#include "cpu_reference/wide_rows.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace pvg {

#if defined(__x86_64__)
namespace {

#define PVG_AVX2 __attribute__((target("avx2")))

/// r[i] with elements 4 i .. 4 i + 3 of each half's 4 x 4 block becomes the block's column i.
PVG_AVX2 inline void transpose(__m256 (&r)[4]) {
    const __m256 a = _mm256_unpacklo_ps(r[0], r[1]), b = _mm256_unpackhi_ps(r[0], r[1]);
    const __m256 c = _mm256_unpacklo_ps(r[2], r[3]), d = _mm256_unpackhi_ps(r[2], r[3]);
    r[0] = _mm256_shuffle_ps(a, c, 0x44);
    r[1] = _mm256_shuffle_ps(a, c, 0xee);
    r[2] = _mm256_shuffle_ps(b, d, 0x44);
    r[3] = _mm256_shuffle_ps(b, d, 0xee);
}

/// Writes the first `rows` lanes of each channel's sum as rows of `channels` floats.
template <int channels>
PVG_AVX2 inline void store_rows(const __m256* sum, std::size_t rows, float* values) {
    if (channels == 1 && rows == 8) {
        _mm256_storeu_ps(values, sum[0]);
        return;
    }
    alignas(32) float lanes[channels][8];
    if (channels >= 4 && rows == 8) {
        __m256 color[4] = {sum[0], sum[1], sum[2], sum[3]};
        transpose(color);
        _mm256_store_ps(lanes[channels - 1], sum[channels - 1]);
#pragma GCC unroll 4
        for (int r = 0; r < 4; ++r) {
            _mm_storeu_ps(values + r * channels, _mm256_castps256_ps128(color[r]));
            _mm_storeu_ps(values + (r + 4) * channels, _mm256_extractf128_ps(color[r], 1));
        }
#pragma GCC unroll 8
        for (int r = 0; r < 8; ++r) values[r * channels + channels - 1] = lanes[channels - 1][r];
        return;
    }
#pragma GCC unroll 5
    for (int c = 0; c < channels; ++c) _mm256_store_ps(lanes[c], sum[c]);
    for (std::size_t r = 0; r < rows; ++r)
        for (int c = 0; c < channels; ++c) values[r * channels + c] = lanes[c][r];
}

template <int channels>
PVG_AVX2 void evaluate(const float* local, std::size_t stride, const float* weights, std::size_t count, float* values) {
    for (std::size_t row = 0; row < count; row += 8) {
        const std::size_t rows = count - row < 8 ? count - row : 8;
        // Lanes beyond the last row repeat it; their sums are not stored.
        const float* w[8];
        for (std::size_t r = 0; r < 8; ++r) w[r] = weights + (row + (r < rows ? r : rows - 1)) * stride;
        __m256 sum[channels];
#pragma GCC unroll 5
        for (int c = 0; c < channels; ++c) sum[c] = _mm256_setzero_ps();
        const float* coefficient = local;
        for (std::size_t k = 0; k < stride; k += 4) {
            // Four weights of eight rows, transposed: weight[i] holds number k + i of every row.
            const auto pair = [&](std::size_t r) PVG_AVX2 {
                return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(w[r] + k)), _mm_loadu_ps(w[r + 4] + k), 1);
            };
            __m256 weight[4] = {pair(0), pair(1), pair(2), pair(3)};
            transpose(weight);
#pragma GCC unroll 4
            for (int i = 0; i < 4; ++i, coefficient += channels) {
#pragma GCC unroll 5
                for (int channel = 0; channel < channels; ++channel) {
                    const __m256 product = _mm256_mul_ps(weight[i], _mm256_broadcast_ss(coefficient + channel));
                    sum[channel] = _mm256_add_ps(sum[channel], product);
                }
            }
        }
        store_rows<channels>(sum, rows, values + row * channels);
    }
}

}  // namespace

bool wide_rows_supported() { return __builtin_cpu_supports("avx2"); }

void evaluate_rows_wide(int channels, const float* local, std::size_t stride, const float* weights, std::size_t count,
                        float* values) {
    if (channels == 1)
        evaluate<1>(local, stride, weights, count, values);
    else if (channels == 4)
        evaluate<4>(local, stride, weights, count, values);
    else
        evaluate<5>(local, stride, weights, count, values);
}

#else

bool wide_rows_supported() { return false; }

void evaluate_rows_wide(int, const float*, std::size_t, const float*, std::size_t, float*) {}

#endif

}  // namespace pvg
