#include "pvg/table.h"

#include <cmath>
#include <string>

namespace pvg {
namespace {

Error broken(const std::string& rule) { return Error(ErrorKind::bad_input, "table: " + rule); }

std::string number(std::uint64_t value) { return std::to_string(value); }

/// first[0] = 0, ascending, last = size. Empty when it holds.
std::string broken_offsets(const char* name, const std::vector<std::uint32_t>& first, std::uint64_t count, std::uint64_t size,
                           bool by_four) {
    const std::string who = name;
    if (first.size() != count + 1)
        return who + " has " + number(first.size()) + " entries, expected cell_count + 1 = " + number(count + 1);
    if (first.front() != 0)
        return who + " starts at " + number(first.front()) + ", expected 0";
    for (std::size_t c = 0; c < count; ++c) {
        if (first[c + 1] < first[c])
            return who + " falls at cell " + number(c);
        if (by_four && first[c + 1] % 4 != 0)
            return who + " is not a multiple of 4 after cell " + number(c);
    }
    if (first.back() != size)
        return who + " ends at " + number(first.back()) + ", expected " + number(size);
    return {};
}

}  // namespace

std::uint64_t Table::bytes() const {
    const auto size = [](const auto& array) { return static_cast<std::uint64_t>(array.size()) * sizeof(array[0]); };
    return size(cell_first_row) + size(cell_first_index) + size(cell_first_weight) + size(indices) + size(weights) +
           size(row_vertex) + size(vertex_row);
}

Result<bool> validate(const Table& table) {
    if (table.channels == 0)
        return broken("channels is 0, expected at least 1");
    std::string rule = broken_offsets("cell_first_row", table.cell_first_row, table.cell_count, table.row_count, false);
    if (rule.empty())
        rule = broken_offsets("cell_first_index", table.cell_first_index, table.cell_count, table.indices.size(), true);
    if (rule.empty())
        rule = broken_offsets("cell_first_weight", table.cell_first_weight, table.cell_count, table.weights.size(), true);
    if (!rule.empty())
        return broken(rule);
    for (std::size_t c = 0; c < table.cell_count; ++c) {
        const std::uint64_t rows = table.cell_first_row[c + 1] - table.cell_first_row[c];
        const std::uint64_t stride = table.cell_first_index[c + 1] - table.cell_first_index[c];
        const std::uint64_t block = table.cell_first_weight[c + 1] - table.cell_first_weight[c];
        if (rows > 0 && stride == 0)
            return broken("cell " + number(c) + " has rows and an empty list");
        if (block != rows * stride)
            return broken("cell " + number(c) + " has a block of " + number(block) + " weights, expected " + number(rows) +
                          " rows x " + number(stride));
    }
    for (std::size_t i = 0; i < table.indices.size(); ++i)
        if (table.indices[i] >= table.coefficient_count)
            return broken("indices[" + number(i) + "] = " + number(table.indices[i]) +
                          ", expected below coefficient_count = " + number(table.coefficient_count));
    for (std::size_t i = 0; i < table.weights.size(); ++i)
        if (!std::isfinite(table.weights[i]))
            return broken("weights[" + number(i) + "] is not finite");
    if (table.row_vertex.size() != table.row_count)
        return broken("row_vertex has " + number(table.row_vertex.size()) + " entries, expected row_count");
    if (table.vertex_row.size() != table.row_count)
        return broken("vertex_row has " + number(table.vertex_row.size()) + " entries, expected row_count");
    for (std::size_t row = 0; row < table.row_count; ++row) {
        const std::uint32_t vertex = table.row_vertex[row];
        if (vertex >= table.row_count)
            return broken("row_vertex[" + number(row) + "] = " + number(vertex) + ", expected below row_count");
        if (table.vertex_row[vertex] != row)
            return broken("vertex_row is not the inverse of row_vertex at row " + number(row));
    }
    return true;
}

}  // namespace pvg
