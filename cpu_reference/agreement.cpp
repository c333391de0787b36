#include "cpu_reference/agreement.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "kernels/shared.h"

namespace pvg {
namespace {

constexpr double u = 1.0 / 8388608;            // 2^-23: a rounding to either neighbour
constexpr double smallest = 1.1754943508e-38;  // 2^-126: what is below may be flushed

/// Floats in order of value, counted from 0.
std::int64_t position_among_floats(float x) {
    const auto bits = std::bit_cast<std::int32_t>(x);
    return bits < 0 ? -std::int64_t(bits & 0x7fffffff) : bits;
}

void compare(const float* a, std::size_t count_a, const float* b, std::size_t count_b, Agreement& agreement) {
    if (count_a != count_b) {
        agreement = {false, std::numeric_limits<double>::infinity()};
        return;
    }
    if (count_a == 0 || std::memcmp(a, b, count_a * sizeof(float)) == 0)
        return;
    agreement.bit_identical = false;
    for (std::size_t i = 0; i < count_a; ++i) {
        const std::int64_t distance = position_among_floats(a[i]) - position_among_floats(b[i]);
        agreement.max_ulp = std::max(agreement.max_ulp, static_cast<double>(std::abs(distance)));
    }
}

const float* numbers(const std::vector<std::array<float, 3>>& v) { return v.empty() ? nullptr : v.front().data(); }

Eigen::Vector3d vector(const std::array<float, 3>& v) { return {v[0], v[1], v[2]}; }

bool near(double found, double expected, double bound) { return std::abs(found - expected) <= bound; }  // false for NaN

std::string beyond(const std::string& what, double found, double expected, double bound) {
    return what + " is " + std::to_string(found) + ", expected " + std::to_string(expected) + " within " + std::to_string(bound);
}

std::string values_beyond_bound(const Field& field, const std::vector<float>& values) {
    const Table& table = field.table;
    for (std::uint32_t cell = 0; cell < table.cell_count; ++cell) {
        const std::size_t list = table.cell_first_index[cell], length = table.cell_first_index[cell + 1] - list;
        std::size_t block = table.cell_first_weight[cell];
        for (std::size_t row = table.cell_first_row[cell]; row < table.cell_first_row[cell + 1]; ++row, block += length) {
            for (std::uint32_t channel = 0; channel < table.channels; ++channel) {
                double sum = 0, size = 0;
                for (std::size_t k = 0; k < length; ++k) {
                    const double coefficient =
                        field.coefficients[std::size_t(table.indices[list + k]) * table.channels + channel];
                    sum += table.weights[block + k] * coefficient;
                    size += std::abs(table.weights[block + k] * coefficient);
                }
                const double found = values[row * table.channels + channel];
                const double bound = static_cast<double>(length + 1) * (u * size + smallest);
                if (!near(found, sum, bound))
                    return beyond("row " + std::to_string(row), found, sum, bound);
            }
        }
    }
    return {};
}

std::string vertex_beyond_bound(const Program& program, const Evaluation& evaluation, std::size_t i) {
    double height = 0, size = 0;
    const std::uint32_t first = program.height_first[i], last = program.height_first[i + 1];
    for (std::uint32_t k = first; k < last; ++k) {
        const HeightTerm& term = program.height_terms[k];
        const std::size_t channels = program.fields[term.field].table.channels;
        const double value = evaluation.values[term.field][term.row * channels + term.channel];
        height += value;
        size += std::abs(value);
    }
    const double bound = (last - first) * (u * size + smallest);
    if (!near(evaluation.height[i], height, bound)) {
        return beyond("height " + std::to_string(i), evaluation.height[i], height, bound);
    }
    for (int axis = 0; axis < 3; ++axis) {
        const double offset = double(evaluation.height[i]) * program.unit;
        const double expected = program.base[i][axis] + offset * program.normal[i][axis];
        const double room = first == last ? 0 : 3 * (u * (std::abs(program.base[i][axis]) + std::abs(offset)) + smallest);
        if (!near(evaluation.position[i][axis], expected, room)) {
            return beyond("position " + std::to_string(i), evaluation.position[i][axis], expected, room);
        }
    }
    return {};
}

std::string normal_beyond_bound(const Program& program, const Evaluation& evaluation, std::size_t i) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double size = 0;
    for (std::uint32_t k = program.corner_first[i]; k < program.corner_first[i + 1]; ++k) {
        const Eigen::Vector3d a = vector(evaluation.position[program.corners[k][0]]);
        // Edges as the kernels see them: a difference of two floats, rounded.
        const Eigen::Vector3d d = (vector(evaluation.position[program.corners[k][1]]) - a).cast<float>().cast<double>();
        const Eigen::Vector3d e = (vector(evaluation.position[program.corners[k][2]]) - a).cast<float>().cast<double>();
        const double dd = d.squaredNorm(), ee = e.squaredNorm();
        if (!(std::min(dd, ee) >= PVG_EDGE_MIN && std::max(dd, ee) <= PVG_EDGE_MAX))
            continue;
        sum += d.cross(e) / dd / ee;
        size += 1 / std::sqrt(dd) / std::sqrt(ee);
    }
    const Eigen::Vector3d found = vector(evaluation.normal[i]);
    const double bound = 24 * u * (1 + (size > 0 ? size / sum.norm() : 0));
    // Where rounding decides about the direction, or about whether there is one, only the length is known.
    if (!(bound < 0.5) || sum.norm() < 2 * PVG_SUM_MIN) {
        if (found.isZero(0) || near(found.norm(), 1, 24 * u))
            return {};
        return beyond("length of normal " + std::to_string(i), found.norm(), 1, 24 * u);
    }
    const Eigen::Vector3d expected = size > 0 ? sum.normalized().eval() : sum;
    for (int axis = 0; axis < 3; ++axis) {
        if (!near(found[axis], expected[axis], bound))
            return beyond("normal " + std::to_string(i), found[axis], expected[axis], bound);
    }
    return {};
}

}  // namespace

Agreement compare_evaluations(const Evaluation& a, const Evaluation& b) {
    Agreement agreement{true, 0};
    if (a.values.size() != b.values.size())
        return {false, std::numeric_limits<double>::infinity()};
    for (std::size_t f = 0; f < a.values.size(); ++f) {
        compare(a.values[f].data(), a.values[f].size(), b.values[f].data(), b.values[f].size(), agreement);
    }
    compare(a.height.data(), a.height.size(), b.height.data(), b.height.size(), agreement);
    compare(numbers(a.position), 3 * a.position.size(), numbers(b.position), 3 * b.position.size(), agreement);
    compare(numbers(a.normal), 3 * a.normal.size(), numbers(b.normal), 3 * b.normal.size(), agreement);
    return agreement;
}

std::string first_beyond_bound(const Program& program, const Evaluation& evaluation) {
    bool sizes = evaluation.values.size() == program.fields.size() && evaluation.height.size() == program.base.size() &&
                 evaluation.position.size() == program.base.size() && evaluation.normal.size() + 1 == program.corner_first.size();
    for (std::size_t f = 0; sizes && f < program.fields.size(); ++f) {
        const Table& table = program.fields[f].table;
        sizes = evaluation.values[f].size() == std::size_t(table.row_count) * table.channels;
    }
    if (!sizes)
        return "the evaluation has other sizes than the program";
    for (std::size_t f = 0; f < program.fields.size(); ++f) {
        const std::string text = values_beyond_bound(program.fields[f], evaluation.values[f]);
        if (!text.empty())
            return "field " + std::to_string(f) + ", " + text;
    }
    for (std::size_t i = 0; i < program.base.size(); ++i) {
        if (std::string text = vertex_beyond_bound(program, evaluation, i); !text.empty())
            return text;
    }
    for (std::size_t i = 0; i < evaluation.normal.size(); ++i) {
        if (std::string text = normal_beyond_bound(program, evaluation, i); !text.empty())
            return text;
    }
    return {};
}

}  // namespace pvg
