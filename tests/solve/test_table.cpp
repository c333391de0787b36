// One broken rule at a time: validate() of tables and programs must name it.
#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "pvg/program.h"

namespace pvg {
namespace {

constexpr float infinite = std::numeric_limits<float>::infinity();

/// Two cells: 2 rows x 4 and 1 row x 8.
Table good_table() {
    Table t;
    t.row_count = 3;
    t.cell_count = 2;
    t.coefficient_count = 5;
    t.channels = 2;
    t.cell_first_row = {0, 2, 3};
    t.cell_first_index = {0, 4, 12};
    t.cell_first_weight = {0, 8, 16};
    t.indices = {0, 1, 2, 2, 4, 3, 2, 1, 0, 0, 0, 0};
    t.weights.assign(16, 0.25f);
    t.row_vertex = {2, 0, 1};
    t.vertex_row = {1, 2, 0};
    return t;
}

Program good_program() {
    Program p;
    p.fields.push_back({good_table(), std::vector<float>(10, 1.0f)});
    p.base = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    p.normal.assign(3, {0, 0, 1});
    p.height_first = {0, 1, 1, 2};
    p.height_terms = {{0, 0, 1}, {0, 2, 0}};
    p.corner_first = {0, 1, 2};
    p.corners = {{0, 1, 2}, {1, 2, 0}};
    return p;
}

struct TableCase {
    const char* name;
    std::function<void(Table&)> damage;
    const char* message;
};

class BrokenTable : public testing::TestWithParam<TableCase> {};

TEST_P(BrokenTable, IsRefusedByName) {
    Table table = good_table();
    GetParam().damage(table);
    const Result<bool> result = validate(table);
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.error().kind(), ErrorKind::bad_input);
    EXPECT_NE(std::string(result.error().what()).find(GetParam().message), std::string::npos) << result.error().what();
}

INSTANTIATE_TEST_SUITE_P(
    EachRule, BrokenTable,
    testing::Values(
        TableCase{"channels", [](Table& table) { table.channels = 0; }, "channels is 0"},
        TableCase{"row_offsets_size", [](Table& table) { table.cell_first_row.pop_back(); }, "cell_first_row has 2 entries"},
        TableCase{"row_offsets_start", [](Table& table) { table.cell_first_row[0] = 1; }, "cell_first_row starts at 1"},
        TableCase{"row_offsets_order", [](Table& table) { table.cell_first_row[1] = 4; }, "cell_first_row falls at cell 1"},
        TableCase{"row_offsets_end", [](Table& table) { table.cell_first_row[2] = 4; }, "cell_first_row ends at 4"},
        TableCase{"no_offsets_at_all", [](Table& table) { table.cell_first_row.clear(); }, "cell_first_row has 0 entries"},
        TableCase{"index_offsets_size", [](Table& table) { table.cell_first_index.push_back(12); },
                  "cell_first_index has 4 entries"},
        TableCase{"index_offsets_by_four", [](Table& table) { table.cell_first_index[1] = 3; },
                  "cell_first_index is not a multiple of 4"},
        TableCase{"index_offsets_end", [](Table& table) { table.indices.push_back(0); }, "cell_first_index ends at 12"},
        TableCase{"weight_offsets_size", [](Table& table) { table.cell_first_weight.clear(); },
                  "cell_first_weight has 0 entries"},
        TableCase{"weight_offsets_by_four", [](Table& table) { table.cell_first_weight[1] = 7; },
                  "cell_first_weight is not a multiple of 4"},
        TableCase{"weight_offsets_end", [](Table& table) { table.weights.pop_back(); }, "cell_first_weight ends at 16"},
        TableCase{"rows_without_a_list",
                  [](Table& table) {
                      table.cell_first_index = {0, 0, 12};
                  },
                  "cell 0 has rows and an empty list"},
        TableCase{"block_size", [](Table& table) { table.cell_first_weight[1] = 4; },
                  "cell 0 has a block of 4 weights, expected 2 rows x 4"},
        TableCase{"index_range", [](Table& table) { table.indices[3] = 5; }, "indices[3] = 5"},
        TableCase{"infinite_weight", [](Table& table) { table.weights[7] = infinite; }, "weights[7] is not finite"},
        TableCase{"weight_not_a_number", [](Table& table) { table.weights[0] = std::nanf(""); }, "weights[0] is not finite"},
        TableCase{"row_vertex_size", [](Table& table) { table.row_vertex.pop_back(); }, "row_vertex has 2 entries"},
        TableCase{"vertex_row_size", [](Table& table) { table.vertex_row.push_back(0); }, "vertex_row has 4 entries"},
        TableCase{"row_vertex_range", [](Table& table) { table.row_vertex[1] = 3; }, "row_vertex[1] = 3"},
        TableCase{"not_inverse", [](Table& table) { table.row_vertex[1] = 1; }, "not the inverse of row_vertex at row 1"}),
    [](const auto& test) { return test.param.name; });

struct ProgramCase {
    const char* name;
    std::function<void(Program&)> damage;
    const char* message;
};

class BrokenProgram : public testing::TestWithParam<ProgramCase> {};

TEST_P(BrokenProgram, IsRefusedByName) {
    Program program = good_program();
    GetParam().damage(program);
    const Result<bool> result = validate(program);
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.error().kind(), ErrorKind::bad_input);
    EXPECT_NE(std::string(result.error().what()).find(GetParam().message), std::string::npos) << result.error().what();
}

INSTANTIATE_TEST_SUITE_P(
    EachRule, BrokenProgram,
    testing::Values(
        ProgramCase{"bad_table", [](Program& program) { program.fields[0].table.indices[0] = 9; },
                    "fields[0]: table: indices[0] = 9"},
        ProgramCase{"coefficients_size", [](Program& program) { program.fields[0].coefficients.pop_back(); },
                    "fields[0] has 9 coefficients"},
        ProgramCase{"coefficients_finite", [](Program& program) { program.fields[0].coefficients[4] = infinite; },
                    "coefficients[4] is not finite"},
        ProgramCase{"normal_size", [](Program& program) { program.normal.pop_back(); }, "normal has 2 entries"},
        ProgramCase{"base_finite", [](Program& program) { program.base[1][2] = infinite; }, "base[1] is not finite"},
        ProgramCase{"normal_finite", [](Program& program) { program.normal[2][0] = infinite; }, "normal[2] is not finite"},
        ProgramCase{"unit_finite", [](Program& program) { program.unit = infinite; }, "unit is not finite"},
        ProgramCase{"height_first_size", [](Program& program) { program.height_first.pop_back(); }, "height_first has 3 entries"},
        ProgramCase{"height_first_order", [](Program& program) { program.height_first[1] = 2; }, "height_first falls at 1"},
        ProgramCase{"height_first_end", [](Program& program) { program.height_terms.pop_back(); }, "height_first ends at 2"},
        ProgramCase{"term_field", [](Program& program) { program.height_terms[1].field = 1; }, "height_terms[1].field = 1"},
        ProgramCase{"term_row", [](Program& program) { program.height_terms[0].row = 3; }, "height_terms[0].row = 3"},
        ProgramCase{"term_channel", [](Program& program) { program.height_terms[0].channel = 2; }, "height_terms[0].channel = 2"},
        ProgramCase{"corner_first_empty", [](Program& program) { program.corner_first.clear(); }, "corner_first is empty"},
        ProgramCase{"corner_first_start", [](Program& program) { program.corner_first[0] = 1; }, "corner_first starts at 1"},
        ProgramCase{"corner_first_end", [](Program& program) { program.corners.pop_back(); }, "corner_first ends at 2"},
        ProgramCase{"corner_vertex", [](Program& program) { program.corners[1][2] = 3; }, "corners[1] names vertex 3"}),
    [](const auto& test) { return test.param.name; });

TEST(Table, GoodOnesPass) {
    EXPECT_TRUE(validate(good_table()).ok());
    EXPECT_TRUE(validate(good_program()).ok());
    Table empty;
    empty.channels = 1;
    empty.cell_first_row = empty.cell_first_index = empty.cell_first_weight = {0};
    EXPECT_TRUE(validate(empty).ok());
}

TEST(Table, BytesCountsAllArrays) { EXPECT_EQ(good_table().bytes(), 4u * (3 + 3 + 3 + 12 + 16 + 3 + 3)); }

}  // namespace
}  // namespace pvg
