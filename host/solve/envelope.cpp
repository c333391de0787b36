#include "solve/envelope.h"

#include <algorithm>
#include <cmath>

namespace pvg {
namespace {

/// Four numbers at a time, in this order everywhere: with AVX2 one instruction, else two, and the same bits.
using Four = double __attribute__((vector_size(32)));
using Loose = double __attribute__((vector_size(32), aligned(8), may_alias));  // anywhere in an array
#define PVG_FOUR(at) (*reinterpret_cast<Loose*>(at))
#define PVG_FOUR_OF(at) (*reinterpret_cast<const Loose*>(at))

struct Envelope {
    const int* end;
    const std::size_t* start;
    int n;
    double* column(double* values, int j) const { return values + start[j] - j; }  // [i]: row i
    const double* column(const double* values, int j) const { return values + start[j] - j; }
};

/// target[i] -= sum over the panel of factor[q] panel[q][i], i in [begin, end).
template <int panel>
[[gnu::always_inline]] inline void subtract(double* target, const double* const* columns, const double* factor, int begin,
                                            int end) {
    int i = begin;
    for (; i + 4 <= end; i += 4) {
        Four four = PVG_FOUR(target + i);
#pragma GCC unroll 4
        for (int q = 0; q < panel; ++q) four -= factor[q] * PVG_FOUR_OF(columns[q] + i);
        PVG_FOUR(target + i) = four;
    }
    for (; i < end; ++i) {
        double one = target[i];
#pragma GCC unroll 4
        for (int q = 0; q < panel; ++q) one -= factor[q] * columns[q][i];
        target[i] = one;
    }
}

/// Columns first .. first + panel - 1, which end in the same row, then what they do to all later ones. diagonal: as added.
template <int panel>
[[gnu::always_inline]] inline int eliminate(const Envelope& e, double* values, const double* diagonal, int first) {
    constexpr double vanishing = 1e-11;
    const int last = first + panel, end = e.end[first];
    int fixed = 0;
    const double* columns[panel];
    for (int q = 0; q < panel; ++q) {
        const int j = first + q;
        double* const own = e.column(values, j);
        for (int p = 0; p < q; ++p) {
            const double factor = columns[p][j];
            subtract<1>(own, columns + p, &factor, j, end);
        }
        const double pivot = own[j];
        // The diagonal holds the inverse of the factor's; 0 fixes the unknown.
        double inverse = 0;
        if (pivot > vanishing * diagonal[j] && std::isfinite(pivot))
            inverse = 1 / std::sqrt(pivot);
        else
            ++fixed;
        own[j] = inverse;
        for (int i = j + 1; i < end; ++i) own[i] *= inverse;
        columns[q] = own;
    }
    for (int c = last; c < end; ++c) {
        double factor[panel];
#pragma GCC unroll 4
        for (int q = 0; q < panel; ++q) factor[q] = columns[q][c];
        subtract<panel>(e.column(values, c), columns, factor, c, end);
    }
    return fixed;
}

[[gnu::always_inline]] inline int factor_all(const Envelope& e, double* values, const double* diagonal) {
    int fixed = 0, j = 0;
    for (; j + 4 <= e.n; j += 4) fixed += eliminate<4>(e, values, diagonal, j);
    for (; j < e.n; ++j) fixed += eliminate<1>(e, values, diagonal, j);
    return fixed;
}

/// `fours` times four columns of X, for `panel` unknowns at a time.
template <int panel, int fours>
[[gnu::always_inline]] inline void forward(const Envelope& e, const double* values, int first, double* X, std::size_t width) {
    Four x[panel][fours];
    const double* columns[panel];
#pragma GCC unroll 4
    for (int q = 0; q < panel; ++q) {
        columns[q] = e.column(values, first + q);
        double* const own = X + static_cast<std::size_t>(first + q) * width;
#pragma GCC unroll 4
        for (int k = 0; k < fours; ++k) {
            x[q][k] = PVG_FOUR_OF(own + 4 * k);
#pragma GCC unroll 4
            for (int p = 0; p < q; ++p) x[q][k] -= columns[p][first + q] * x[p][k];
            x[q][k] *= columns[q][first + q];
            PVG_FOUR(own + 4 * k) = x[q][k];
        }
    }
    for (int i = first + panel; i < e.end[first]; ++i) {
        double* const other = X + static_cast<std::size_t>(i) * width;
#pragma GCC unroll 4
        for (int k = 0; k < fours; ++k) {
            Four four = PVG_FOUR_OF(other + 4 * k);
#pragma GCC unroll 4
            for (int q = 0; q < panel; ++q) four -= columns[q][i] * x[q][k];
            PVG_FOUR(other + 4 * k) = four;
        }
    }
}

template <int panel, int fours>
[[gnu::always_inline]] inline void backward(const Envelope& e, const double* values, int first, double* X, std::size_t width) {
    Four x[panel][fours];
    const double* columns[panel];
#pragma GCC unroll 4
    for (int q = 0; q < panel; ++q) {
        columns[q] = e.column(values, first + q);
#pragma GCC unroll 4
        for (int k = 0; k < fours; ++k) x[q][k] = PVG_FOUR_OF(X + static_cast<std::size_t>(first + q) * width + 4 * k);
    }
    for (int i = first + panel; i < e.end[first]; ++i) {
        const double* const other = X + static_cast<std::size_t>(i) * width;
#pragma GCC unroll 4
        for (int k = 0; k < fours; ++k) {
            const Four four = PVG_FOUR_OF(other + 4 * k);
#pragma GCC unroll 4
            for (int q = 0; q < panel; ++q) x[q][k] -= columns[q][i] * four;
        }
    }
#pragma GCC unroll 4
    for (int q = panel - 1; q >= 0; --q)
#pragma GCC unroll 4
        for (int k = 0; k < fours; ++k) {
#pragma GCC unroll 4
            for (int p = q + 1; p < panel; ++p) x[q][k] -= columns[q][first + p] * x[p][k];
            x[q][k] *= columns[q][first + q];
            PVG_FOUR(X + static_cast<std::size_t>(first + q) * width + 4 * k) = x[q][k];
        }
}

template <int fours>
[[gnu::always_inline]] inline void solve_columns(const Envelope& e, const double* values, double* X, std::size_t width) {
    int j = 0;
    for (; j + 4 <= e.n; j += 4) forward<4, fours>(e, values, j, X, width);
    for (; j < e.n; ++j) forward<1, fours>(e, values, j, X, width);
    const int whole = e.n / 4 * 4;
    for (j = e.n - 1; j >= whole; --j) backward<1, fours>(e, values, j, X, width);
    for (j = whole - 4; j >= 0; j -= 4) backward<4, fours>(e, values, j, X, width);
}

[[gnu::always_inline]] inline void solve_all(const Envelope& e, const double* values, double* X, std::size_t width) {
    std::size_t column = 0;
    for (; column + 8 <= width; column += 8) solve_columns<2>(e, values, X + column, width);
    if (column < width)
        solve_columns<1>(e, values, X + column, width);
}

int factor_plain(const Envelope& e, double* values, const double* diagonal) { return factor_all(e, values, diagonal); }
void solve_plain(const Envelope& e, const double* values, double* X, std::size_t width) { solve_all(e, values, X, width); }

#if defined(__x86_64__)
[[gnu::target("avx2")]] int factor_wide(const Envelope& e, double* values, const double* diagonal) {
    return factor_all(e, values, diagonal);
}
[[gnu::target("avx2")]] void solve_wide(const Envelope& e, const double* values, double* X, std::size_t width) {
    solve_all(e, values, X, width);
}
bool wide() { return __builtin_cpu_supports("avx2"); }
#else
constexpr auto factor_wide = factor_plain;
constexpr auto solve_wide = solve_plain;
bool wide() { return false; }
#endif

#undef PVG_FOUR
#undef PVG_FOUR_OF

}  // namespace

void EnvelopeCholesky::begin(const std::vector<int>& first_column) {
    size_ = static_cast<int>(first_column.size());
    end_.resize(first_column.size());
    for (int j = 0; j < size_; ++j) end_[j] = j + 1;
    for (int i = 0; i < size_; ++i) end_[first_column[i]] = std::max(end_[first_column[i]], i + 1);
    for (int j = 1; j < size_; ++j) end_[j] = std::max(end_[j], end_[j - 1]);
    // Four columns that are eliminated together end together.
    for (int j = 0; j + 4 <= size_; j += 4) std::fill(end_.begin() + j, end_.begin() + j + 3, end_[j + 3]);
    start_.resize(first_column.size() + 1);
    start_[0] = 0;
    for (int j = 0; j < size_; ++j) start_[j + 1] = start_[j] + static_cast<std::size_t>(end_[j] - j);
    values_.assign(start_.back(), 0.0);
}

int EnvelopeCholesky::factor() {
    diagonal_.resize(end_.size());
    for (int j = 0; j < size_; ++j) diagonal_[j] = values_[start_[j]];
    const Envelope envelope{end_.data(), start_.data(), size_};
    return wide() ? factor_wide(envelope, values_.data(), diagonal_.data())
                  : factor_plain(envelope, values_.data(), diagonal_.data());
}

void EnvelopeCholesky::solve(RowMatrix& X) const {
    const Envelope envelope{end_.data(), start_.data(), size_};
    const auto width = static_cast<std::size_t>(X.cols());
    if (wide())
        solve_wide(envelope, values_.data(), X.data(), width);
    else
        solve_plain(envelope, values_.data(), X.data(), width);
}

}  // namespace pvg
