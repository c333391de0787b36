// The twin of kernels/evaluate.comp, displace.comp and normals.comp: same operations, same order, single precision.
#include "cpu_reference/cpu_evaluator.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <thread>

#include <Eigen/Core>

#include "cpu_reference/wide_rows.h"
#include "kernels/shared.h"

namespace pvg {
namespace {

/// Runs body(first, last) on equal parts of [0, count). Every item is computed by itself, so the parts do not matter.
template <typename Body>
void for_ranges(std::size_t count, int threads, const Body& body) {
    const std::size_t smallest = 4096;  // items that are worth a thread
    const std::size_t parts = std::min<std::size_t>(static_cast<std::size_t>(std::max(threads, 1)), count / smallest + 1);
    std::vector<std::jthread> workers;
    for (std::size_t part = 1; part < parts; ++part) {
        workers.emplace_back([&, part] { body(count * part / parts, count * (part + 1) / parts); });
    }
    body(0, count / parts);
}

/// Rows first .. last - 1 of one cell, `block` at a time and the rest left over; each row's own sum keeps its order. Returns
/// the first row that is left. Channels come as four and one, so that the four are one vector on every compiler.
template <int channels, int block>
std::size_t evaluate_block(const float* coefficients, const std::uint32_t* list, std::size_t stride, const float* weights,
                           std::size_t first, std::size_t last, float* values) {
    using Color = Eigen::Array4f;
    std::size_t row = first;
    for (; row + block <= last; row += block) {
        Color color[block];
        float scalar[block] = {};
        for (Color& sum : color) sum.setZero();
        const float* w = weights + (row - first) * stride;
        for (std::size_t k = 0; k < stride; ++k) {
            const float* c = coefficients + std::size_t(list[k]) * channels;
            for (int r = 0; r < block; ++r) {
                const float weight = w[std::size_t(r) * stride + k];
                if constexpr (channels >= 4)
                    color[r] = color[r] + weight * Eigen::Map<const Color>(c);
                if constexpr (channels != 4)
                    scalar[r] = scalar[r] + weight * c[channels - 1];
            }
        }
        float* out = values + row * channels;
        for (int r = 0; r < block; ++r, out += channels) {
            if constexpr (channels >= 4)
                Eigen::Map<Color>{out} = color[r];
            if constexpr (channels != 4)
                out[channels - 1] = scalar[r];
        }
    }
    return row;
}

template <int channels>
void evaluate_rows(const Field& field, std::size_t first, std::size_t last, bool wide, float* values) {
    const Table& table = field.table;
    if (first == last)
        return;
    const float* coefficients = field.coefficients.data();
    std::vector<float> local;  // the coefficients of one cell's list
    auto cell = std::size_t(std::upper_bound(table.cell_first_row.begin(), table.cell_first_row.end(), first) -
                            table.cell_first_row.begin() - 1);
    for (std::size_t row = first; row < last; ++cell) {
        const std::size_t cell_begin = table.cell_first_row[cell];
        const std::size_t end = std::min<std::size_t>(table.cell_first_row[cell + 1], last);
        const std::uint32_t* list = table.indices.data() + table.cell_first_index[cell];
        const std::size_t stride = table.cell_first_index[cell + 1] - table.cell_first_index[cell];
        const float* weights = table.weights.data() + table.cell_first_weight[cell];
        if (wide) {
            local.resize(stride * channels);
            for (std::size_t k = 0; k < stride; ++k)
                std::copy_n(coefficients + std::size_t(list[k]) * channels, channels, local.data() + k * channels);
            evaluate_rows_wide(channels, local.data(), stride, weights + (row - cell_begin) * stride, end - row,
                               values + row * channels);
            row = end;
            continue;
        }
        const std::size_t single =
            evaluate_block<channels, 4>(coefficients, list, stride, weights + (row - cell_begin) * stride, row, end, values);
        evaluate_block<channels, 1>(coefficients, list, stride, weights + (single - cell_begin) * stride, single, end, values);
        row = end;
    }
}

void displace_vertices(const Program& program, const Evaluation& fields, std::size_t first, std::size_t last, float* heights,
                       std::array<float, 3>* positions) {
    for (std::size_t i = first; i < last; ++i) {
        const std::uint32_t begin = program.height_first[i], end = program.height_first[i + 1];
        float height = 0;
        for (std::uint32_t k = begin; k < end; ++k) {
            const HeightTerm& term = program.height_terms[k];
            const std::size_t channels = program.fields[term.field].table.channels;
            height = height + fields.values[term.field][term.row * channels + term.channel];
        }
        std::array<float, 3> position = program.base[i];
        if (begin < end) {
            const float offset = height * program.unit;
            for (int axis = 0; axis < 3; ++axis) position[axis] = position[axis] + offset * program.normal[i][axis];
        }
        heights[i] = height;
        positions[i] = position;
    }
}

float largest(const float* v) { return std::max(std::max(std::fabs(v[0]), std::fabs(v[1])), std::fabs(v[2])); }

std::array<float, 3> shading_normal(const Program& program, const std::vector<std::array<float, 3>>& positions, std::size_t i) {
    float sum[3] = {0, 0, 0};
    for (std::uint32_t k = program.corner_first[i]; k < program.corner_first[i + 1]; ++k) {
        const std::array<float, 3>& a = positions[program.corners[k][0]];
        const std::array<float, 3>& b = positions[program.corners[k][1]];
        const std::array<float, 3>& p = positions[program.corners[k][2]];
        const float d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
        const float e[3] = {p[0] - a[0], p[1] - a[1], p[2] - a[2]};
        const float dd = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        const float ee = e[0] * e[0] + e[1] * e[1] + e[2] * e[2];
        if (!(dd >= PVG_EDGE_MIN && dd <= PVG_EDGE_MAX && ee >= PVG_EDGE_MIN && ee <= PVG_EDGE_MAX))
            continue;
        const float inverse_d = kernels::inverse_square_root(dd);
        const float inverse_e = kernels::inverse_square_root(ee);
        float c[3] = {d[1] * e[2] - d[2] * e[1], d[2] * e[0] - d[0] * e[2], d[0] * e[1] - d[1] * e[0]};
        for (float& x : c) x = x * inverse_d * inverse_e;
        if (!(largest(c) >= PVG_SINE_MIN))
            continue;
        for (float& x : c) x = x * inverse_d * inverse_e;
        for (int axis = 0; axis < 3; ++axis) sum[axis] = sum[axis] + c[axis];
    }
    const float m = largest(sum);
    if (!(m >= PVG_SUM_MIN))
        return {0, 0, 0};
    const float scale = kernels::inverse_power_of_two(m);
    const float s[3] = {sum[0] * scale, sum[1] * scale, sum[2] * scale};
    const float inverse = kernels::inverse_square_root(s[0] * s[0] + s[1] * s[1] + s[2] * s[2]);
    return {s[0] * inverse, s[1] * inverse, s[2] * inverse};
}

}  // namespace

Evaluation evaluate_on_cpu(const Program& program, int threads) {
    Evaluation result;
    evaluate_on_cpu(program, result, threads);
    return result;
}

void evaluate_on_cpu(const Program& program, Evaluation& result, int threads, bool wide) {
    wide = wide && wide_rows_supported();
    if (threads <= 0)
        threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    result.values.resize(program.fields.size());
    for (std::size_t f = 0; f < program.fields.size(); ++f) {
        const Field& field = program.fields[f];
        std::vector<float>& values = result.values[f];
        values.resize(std::size_t(field.table.row_count) * field.table.channels);
        for_ranges(field.table.row_count, threads, [&](std::size_t first, std::size_t last) {
            switch (field.table.channels) {
                case 1:
                    evaluate_rows<1>(field, first, last, wide, values.data());
                    break;
                case 4:
                    evaluate_rows<4>(field, first, last, wide, values.data());
                    break;
                case 5:
                    evaluate_rows<5>(field, first, last, wide, values.data());
                    break;
                default:
                    break;  // validate() admits no other count
            }
        });
    }
    result.height.resize(program.base.size());
    result.position.resize(program.base.size());
    for_ranges(program.base.size(), threads, [&](std::size_t first, std::size_t last) {
        displace_vertices(program, result, first, last, result.height.data(), result.position.data());
    });
    result.normal.resize(program.corner_first.empty() ? 0 : program.corner_first.size() - 1);
    for_ranges(result.normal.size(), threads, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) result.normal[i] = shading_normal(program, result.position, i);
    });
}

}  // namespace pvg
