// Synthetic programs: random tables, heights and corners of any size, every number reproducible.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "pvg/program.h"

namespace pvg::test {

/// Uniform in [low, high); std::uniform_real_distribution differs between standard libraries.
inline float uniform(std::mt19937& random, float low, float high) {
    return low + (high - low) * (static_cast<float>(random() >> 8) / 16777216.0f);
}

inline std::uint32_t below(std::mt19937& random, std::uint32_t count) { return random() % count; }

/// rows in cells of 0 to 15 rows with lists of 1 to 2 x entries indices; entries below 0: exactly -entries.
inline Field random_field(std::mt19937& random, std::uint32_t rows, std::uint32_t coefficients, std::uint32_t channels,
                          int entries = 20) {
    Field field;
    Table& table = field.table;
    table.row_count = rows;
    table.coefficient_count = coefficients;
    table.channels = channels;
    table.cell_first_row = table.cell_first_index = table.cell_first_weight = {0};
    for (std::uint32_t row = 0; row < rows;) {
        const std::uint32_t in_cell = std::min(below(random, 16), rows - row);
        const std::uint32_t length = entries < 0 ? std::uint32_t(-entries) : 1 + below(random, std::uint32_t(2 * entries));
        const std::uint32_t stride = (length + 3) / 4 * 4;
        std::uint32_t last = 0;
        for (std::uint32_t k = 0; k < stride; ++k) {
            if (k < length)
                last = below(random, coefficients);
            table.indices.push_back(last);
        }
        for (std::uint32_t r = 0; r < in_cell; ++r) {
            for (std::uint32_t k = 0; k < stride; ++k) table.weights.push_back(k < length ? uniform(random, -0.5f, 1.0f) : 0.0f);
        }
        row += in_cell;
        table.cell_first_row.push_back(row);
        table.cell_first_index.push_back(static_cast<std::uint32_t>(table.indices.size()));
        table.cell_first_weight.push_back(static_cast<std::uint32_t>(table.weights.size()));
    }
    table.cell_count = static_cast<std::uint32_t>(table.cell_first_row.size()) - 1;
    table.row_vertex.resize(rows);
    table.vertex_row.resize(rows);
    for (std::uint32_t row = 0; row < rows; ++row) table.row_vertex[row] = row;
    for (std::uint32_t row = rows; row > 1; --row) std::swap(table.row_vertex[row - 1], table.row_vertex[below(random, row)]);
    for (std::uint32_t row = 0; row < rows; ++row) table.vertex_row[table.row_vertex[row]] = row;
    for (std::uint64_t i = 0; i < std::uint64_t(coefficients) * channels; ++i)
        field.coefficients.push_back(uniform(random, -2, 2));
    return field;
}

/// A table as builds make them: cells of 10 to 100 rows, one coefficient a cell, lists of 14 to 16 cells near by.
inline Field neighbour_field(std::mt19937& random, std::uint32_t rows, std::uint32_t channels) {
    Field field;
    Table& table = field.table;
    table.row_count = rows;
    table.channels = channels;
    table.cell_first_row = table.cell_first_index = table.cell_first_weight = {0};
    while (table.cell_first_row.back() < rows)
        table.cell_first_row.push_back(std::min(table.cell_first_row.back() + 10 + below(random, 91), rows));
    table.cell_count = table.coefficient_count = static_cast<std::uint32_t>(table.cell_first_row.size()) - 1;
    for (std::uint32_t cell = 0; cell < table.cell_count; ++cell) {
        const std::uint32_t length = 14 + below(random, 3);
        const std::uint32_t in_cell = table.cell_first_row[cell + 1] - table.cell_first_row[cell];
        for (std::uint32_t k = 0; k < 16; ++k) {
            const std::uint32_t near_by = cell + below(random, 200) + table.cell_count - std::min(table.cell_count, 100u);
            table.indices.push_back(k < length ? near_by % table.cell_count : table.indices.back());
        }
        for (std::uint32_t r = 0; r < in_cell; ++r)
            for (std::uint32_t k = 0; k < 16; ++k) table.weights.push_back(k < length ? uniform(random, -0.5f, 1.0f) : 0.0f);
        table.cell_first_index.push_back(static_cast<std::uint32_t>(table.indices.size()));
        table.cell_first_weight.push_back(static_cast<std::uint32_t>(table.weights.size()));
    }
    for (std::uint32_t row = 0; row < rows; ++row) table.row_vertex.push_back(row);
    table.vertex_row = table.row_vertex;
    for (std::uint64_t i = 0; i < std::uint64_t(table.coefficient_count) * channels; ++i)
        field.coefficients.push_back(uniform(random, -2, 2));
    return field;
}

/// A closed tube of rings x 16 vertices around a random axis curve, displaced by height terms of the fields (0 to most_terms
/// a vertex). Every seventh vertex has no term. One shading normal a vertex, then one whose corners are all degenerate,
/// one without corners, and one of collinear corners.
inline void add_surface(std::mt19937& random, Program& program, std::uint32_t rings, std::uint32_t most_terms, bool ascending) {
    const std::uint32_t around = 16;
    const std::uint32_t count = rings * around;
    program.unit = 0.37f;
    program.height_first = {0};
    program.corner_first = {0};
    for (std::uint32_t i = 0; i < count; ++i) {
        const double angle = 6.283185307179586 * (i % around) / around;
        const float x = static_cast<float>(std::cos(angle)), y = static_cast<float>(std::sin(angle));
        program.base.push_back({x, y, 0.3f * static_cast<float>(i / around) + uniform(random, -0.02f, 0.02f)});
        program.normal.push_back({x, y, 0});
        const std::uint32_t terms = i % 7 == 0 || program.fields.empty() ? 0 : below(random, most_terms + 1);
        std::uint32_t field = 0;
        for (std::uint32_t k = 0; k < terms; ++k) {
            const auto fields = static_cast<std::uint32_t>(program.fields.size());
            field = ascending ? field + below(random, fields - field) : below(random, fields);
            const Table& table = program.fields[field].table;
            if (table.row_count)
                program.height_terms.push_back({field, below(random, table.row_count), table.channels - 1});
        }
        program.height_first.push_back(static_cast<std::uint32_t>(program.height_terms.size()));
    }
    const auto vertex = [&](std::uint32_t ring, std::uint32_t k) { return ring * around + k % around; };
    for (std::uint32_t ring = 0; ring < rings; ++ring) {
        for (std::uint32_t k = 0; k < around; ++k) {
            const std::uint32_t a = vertex(ring, k);
            if (ring + 1 < rings) {
                program.corners.push_back({a, vertex(ring, k + 1), vertex(ring + 1, k + 1)});
                program.corners.push_back({a, vertex(ring + 1, k + 1), vertex(ring + 1, k)});
            }
            if (ring > 0)
                program.corners.push_back({a, vertex(ring - 1, k + around - 1), vertex(ring - 1, k)});
            program.corner_first.push_back(static_cast<std::uint32_t>(program.corners.size()));
        }
    }
    if (!count)
        return;
    program.corners.push_back({0, 0, 0});
    program.corners.push_back({0, 7, 7});
    program.corner_first.push_back(static_cast<std::uint32_t>(program.corners.size()));
    program.corner_first.push_back(static_cast<std::uint32_t>(program.corners.size()));
    // Three vertices without terms on a line that no coordinate axis is parallel to.
    for (int k = 0; k < 3; ++k) {
        const float t = k == 2 ? 3.0f : static_cast<float>(k);
        program.base.push_back({0.1f + 0.7f * t, 0.2f + 0.3f * t, 0.3f - 0.9f * t});
        program.normal.push_back({0, 0, 1});
        program.height_first.push_back(program.height_first.back());
    }
    program.corners.push_back({count, count + 1, count + 2});
    program.corner_first.push_back(static_cast<std::uint32_t>(program.corners.size()));
}

/// Fields with 1, 4 and 5 channels (one of them without rows) and a displaced tube.
inline Program random_program(std::uint32_t seed, std::uint32_t rows, std::uint32_t rings, bool ascending = true) {
    std::mt19937 random(seed);
    Program program;
    program.fields.push_back(random_field(random, rows, rows / 5 + 1, 1));
    program.fields.push_back(random_field(random, rows, rows / 7 + 3, 5));
    program.fields.push_back(random_field(random, 0, 0, 4));
    program.fields.push_back(random_field(random, rows + 3, rows / 5 + 1, 4));
    add_surface(random, program, rings, 3, ascending);
    return program;
}

}  // namespace pvg::test
