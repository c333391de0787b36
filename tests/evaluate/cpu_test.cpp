// The CPU evaluator against sums in double precision, and the laws of what it returns.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>

#include "cpu_reference/agreement.h"
#include "cpu_reference/cpu_evaluator.h"
#include "evaluate/bits.h"
#include "evaluate/random_program.h"
#include "kernels/shared.h"

namespace pvg {
namespace {

using test::random_program;

TEST(CpuEvaluator, InverseSquareRootIsAccurate) {
    std::mt19937 random(1);
    double worst = 0;
    for (int i = 0; i < 2'000'000; ++i) {
        const auto x = static_cast<float>(std::pow(10.0, test::uniform(random, -36, 36)));
        const double exact = 1 / std::sqrt(static_cast<double>(x));
        const double ulp = std::ldexp(1.0, std::ilogb(exact) - 23);
        worst = std::max(worst, std::abs(kernels::inverse_square_root(x) - exact) / ulp);
    }
    EXPECT_LE(worst, 2.0);  // four roundings near the fixed point; 1.6 seen
    RecordProperty("worst_ulp", std::to_string(worst));
}

TEST(CpuEvaluator, ValuesMatchDoublePrecisionSums) {
    for (std::uint32_t rows : {1u, 33u, 5001u}) {
        const Program program = random_program(rows, rows, 4);
        const Evaluation result = evaluate_on_cpu(program, 1);
        ASSERT_EQ(result.values.size(), program.fields.size());
        for (std::size_t f = 0; f < program.fields.size(); ++f) {
            const Field& field = program.fields[f];
            const Table& table = field.table;
            ASSERT_EQ(result.values[f].size(), std::size_t(table.row_count) * table.channels);
            for (std::uint32_t cell = 0; cell < table.cell_count; ++cell) {
                const std::uint32_t list = table.cell_first_index[cell], length = table.cell_first_index[cell + 1] - list;
                for (std::uint32_t row = table.cell_first_row[cell]; row < table.cell_first_row[cell + 1]; ++row) {
                    const std::size_t block =
                        table.cell_first_weight[cell] + std::size_t(row - table.cell_first_row[cell]) * length;
                    for (std::uint32_t channel = 0; channel < table.channels; ++channel) {
                        double sum = 0, size = 0;
                        for (std::uint32_t k = 0; k < length; ++k) {
                            const double term =
                                double(table.weights[block + k]) *
                                field.coefficients[std::size_t(table.indices[list + k]) * table.channels + channel];
                            sum += term;
                            size += std::abs(term);
                        }
                        // A product and `length` additions, each within half an ulp of a partial sum of at most `size`.
                        ASSERT_NEAR(result.values[f][std::size_t(row) * table.channels + channel], sum,
                                    (length + 1) * 6e-8 * size + 1e-30);
                    }
                }
            }
        }
    }
}

TEST(CpuEvaluator, ARowWithOneUnitWeightIsItsCoefficient) {
    std::mt19937 random(3);
    Program program;
    program.height_first = program.corner_first = {0};
    program.fields.push_back(test::random_field(random, 500, 90, 5, -7));
    Table& table = program.fields[0].table;
    std::fill(table.weights.begin(), table.weights.end(), 0.0f);
    for (std::size_t first = 0; first < table.weights.size(); first += 8) table.weights[first + 5] = 1;
    const Evaluation result = evaluate_on_cpu(program);
    for (std::uint32_t cell = 0; cell < table.cell_count; ++cell) {
        for (std::uint32_t row = table.cell_first_row[cell]; row < table.cell_first_row[cell + 1]; ++row) {
            const std::uint32_t own = table.indices[table.cell_first_index[cell] + 5];
            for (std::uint32_t k = 0; k < 5; ++k) {
                ASSERT_EQ(result.values[0][std::size_t(row) * 5 + k], program.fields[0].coefficients[std::size_t(own) * 5 + k]);
            }
        }
    }
}

TEST(CpuEvaluator, PositionsAreBasePlusHeight) {
    const Program program = random_program(5, 700, 40, false);
    const Evaluation result = evaluate_on_cpu(program);
    std::size_t displaced = 0;
    for (std::size_t i = 0; i < program.base.size(); ++i) {
        double height = 0;
        for (std::uint32_t k = program.height_first[i]; k < program.height_first[i + 1]; ++k) {
            const HeightTerm& term = program.height_terms[k];
            height += result.values[term.field][std::size_t(term.row) * program.fields[term.field].table.channels + term.channel];
        }
        EXPECT_NEAR(result.height[i], height, 1e-5);  // three terms below 40
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_NEAR(result.position[i][axis], program.base[i][axis] + height * program.unit * program.normal[i][axis], 1e-5);
        }
        if (program.height_first[i] == program.height_first[i + 1]) {
            EXPECT_EQ(std::memcmp(&result.position[i], &program.base[i], sizeof(program.base[i])), 0);
            EXPECT_EQ(result.height[i], 0);
        } else {
            ++displaced;
        }
    }
    EXPECT_GT(displaced, program.base.size() / 2);
}

TEST(CpuEvaluator, NormalsMatchMaxsFormula) {
    const Program program = random_program(6, 700, 40);
    const Evaluation result = evaluate_on_cpu(program);
    const std::size_t count = result.normal.size();
    ASSERT_EQ(count, program.corner_first.size() - 1);
    for (std::size_t i = 0; i + 3 < count; ++i) {
        double sum[3] = {0, 0, 0}, size = 0;
        for (std::uint32_t k = program.corner_first[i]; k < program.corner_first[i + 1]; ++k) {
            double d[3], e[3], dd = 0, ee = 0;
            for (int axis = 0; axis < 3; ++axis) {
                d[axis] = double(result.position[program.corners[k][1]][axis]) - result.position[program.corners[k][0]][axis];
                e[axis] = double(result.position[program.corners[k][2]][axis]) - result.position[program.corners[k][0]][axis];
                dd += d[axis] * d[axis];
                ee += e[axis] * e[axis];
            }
            for (int axis = 0; axis < 3; ++axis) {
                sum[axis] += (d[(axis + 1) % 3] * e[(axis + 2) % 3] - d[(axis + 2) % 3] * e[(axis + 1) % 3]) / (dd * ee);
            }
            size += 1 / std::sqrt(dd * ee);
        }
        const double length = std::sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
        // About twenty roundings of terms whose sizes add up to `size`.
        const double tolerance = 20 * 6e-8 * (size / length + 1);
        for (int axis = 0; axis < 3; ++axis) ASSERT_NEAR(result.normal[i][axis], sum[axis] / length, tolerance) << i;
    }
    for (std::size_t i = count - 3; i < count; ++i) {
        for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(result.normal[i][axis], 0) << "degenerate normal " << i + 3 - count;
    }
}

TEST(CpuEvaluator, NormalsDoNotDependOnScale) {
    Program program = random_program(7, 200, 12);
    const Evaluation one = evaluate_on_cpu(program);
    for (float scale : {0x1p-40f, 0x1p-10f, 0x1p20f, 0x1p45f}) {  // powers of two: positions scale exactly
        Program scaled = program;
        scaled.unit *= scale;
        for (auto& point : scaled.base) {
            for (float& x : point) x *= scale;
        }
        const Evaluation other = evaluate_on_cpu(scaled);
        for (std::size_t i = 0; i < one.normal.size(); ++i) {
            for (int axis = 0; axis < 3; ++axis) ASSERT_NEAR(one.normal[i][axis], other.normal[i][axis], 1e-6) << scale;
        }
    }
}

TEST(CpuEvaluator, ThreadsChangeNothing) {
    const Program program = random_program(8, 30'011, 1000, false);
    const Evaluation one = evaluate_on_cpu(program, 1);
    for (int threads : {0, 2, 3, 8}) EXPECT_EQ(test::first_difference(one, evaluate_on_cpu(program, threads)), "") << threads;
}

TEST(Agreement, TheCpuIsWithinTheStatedBoundAndErrorsAreNot) {
    const Program program = random_program(9, 700, 40, false);
    const Evaluation right = evaluate_on_cpu(program);
    EXPECT_EQ(first_beyond_bound(program, right), "");
    const auto spoilt = [&](const std::function<float&(Evaluation&)>& number, float by) {
        Evaluation wrong = right;
        float& x = number(wrong);
        x += by;
        EXPECT_NE(first_beyond_bound(program, wrong), "");
        const Agreement agreement = compare_evaluations(right, wrong);
        EXPECT_FALSE(agreement.bit_identical);
        EXPECT_GT(agreement.max_ulp, 10);
    };
    spoilt([](Evaluation& e) -> float& { return e.values[0][3]; }, 1e-3f);
    spoilt([](Evaluation& e) -> float& { return e.height[5]; }, 1e-3f);
    spoilt([](Evaluation& e) -> float& { return e.position[7][2]; }, 1e-5f);
    spoilt([](Evaluation& e) -> float& { return e.normal[9][1]; }, 1e-3f);
    Evaluation longer = right;
    longer.height.push_back(0);
    EXPECT_NE(first_beyond_bound(program, longer), "");
    EXPECT_TRUE(std::isinf(compare_evaluations(right, longer).max_ulp));
    Evaluation next = right;
    next.height[5] = std::nextafter(next.height[5], 100.0f);
    EXPECT_EQ(compare_evaluations(right, next).max_ulp, 1);
    EXPECT_TRUE(compare_evaluations(right, right).bit_identical);
}

TEST(CpuEvaluator, EmptyProgram) {
    Program program;
    program.height_first = program.corner_first = {0};
    const Evaluation result = evaluate_on_cpu(program);
    EXPECT_TRUE(result.values.empty() && result.height.empty() && result.position.empty() && result.normal.empty());
}

TEST(CpuEvaluator, WideRowsChangeNoBit) {
    for (int entries : {1, 3, 20, -16}) {
        std::mt19937 random(31);
        Program program;
        program.height_first = program.corner_first = {0};
        for (std::uint32_t channels : {1u, 4u, 5u}) {
            program.fields.push_back(test::random_field(random, 3001, 200, channels, entries));
            program.fields.push_back(test::neighbour_field(random, 9001, channels));
        }
        Evaluation narrow;
        evaluate_on_cpu(program, narrow, 2, false);
        EXPECT_EQ(test::first_difference(narrow, evaluate_on_cpu(program, 1)), "") << entries;
        EXPECT_EQ(test::first_difference(narrow, evaluate_on_cpu(program, 2)), "") << entries;
    }
}

}  // namespace
}  // namespace pvg
