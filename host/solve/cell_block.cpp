#include "solve/cell_block.h"

#include <algorithm>
#include <cstddef>

namespace pvg {

Table table_of_blocks(const PatchSpace& space, const std::vector<CellBlock>& blocks) {
    Table table;
    const Domain& domain = space.domain;
    const int vertices = domain.surface.vertex_count(), cells = static_cast<int>(blocks.size());
    table.row_count = static_cast<std::uint32_t>(vertices);
    table.cell_count = static_cast<std::uint32_t>(cells);
    table.coefficient_count = static_cast<std::uint32_t>(space.knots.vertex.size() + domain.sources.size());
    table.channels = static_cast<std::uint32_t>(domain.channels);
    table.cell_first_row.push_back(0);
    table.cell_first_index.push_back(0);
    table.cell_first_weight.push_back(0);
    std::vector<char> has_row(vertices, 0);
    for (int c = 0; c < cells; ++c) {
        const CellBlock& block = blocks[c];
        for (int i = space.cell_first[c]; i < space.cell_first[c + 1]; ++i) {
            table.row_vertex.push_back(static_cast<std::uint32_t>(space.cell_vertices[i]));
            has_row[space.cell_vertices[i]] = 1;
        }
        const std::size_t stride = (block.list.size() + 3) / 4 * 4;
        for (std::size_t e = 0; e < stride; ++e)
            table.indices.push_back(static_cast<std::uint32_t>(block.list[std::min(e, block.list.size() - 1)]));
        for (Eigen::Index i = 0; i < block.weights.rows(); ++i) {
            for (Eigen::Index e = 0; e < block.weights.cols(); ++e)
                table.weights.push_back(static_cast<float>(block.weights(i, e)));
            table.weights.insert(table.weights.end(), stride - block.list.size(), 0.0f);
        }
        if (c + 1 == cells)  // vertices without faces: rows of zeros in the last cell, so that rows stay a permutation
            for (int v = 0; v < vertices; ++v)
                if (!has_row[v]) {
                    table.row_vertex.push_back(static_cast<std::uint32_t>(v));
                    table.weights.insert(table.weights.end(), stride, 0.0f);
                }
        table.cell_first_row.push_back(static_cast<std::uint32_t>(table.row_vertex.size()));
        table.cell_first_index.push_back(static_cast<std::uint32_t>(table.indices.size()));
        table.cell_first_weight.push_back(static_cast<std::uint32_t>(table.weights.size()));
    }
    table.vertex_row.assign(vertices, 0);
    for (std::size_t row = 0; row < table.row_vertex.size(); ++row)
        table.vertex_row[table.row_vertex[row]] = static_cast<std::uint32_t>(row);
    return table;
}

}  // namespace pvg
