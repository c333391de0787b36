// The basis table: u(row) = sum over j of weight[row][j] * coefficient[index[cell of row][j]].
// One format for both evaluators: built once, validated once, uploaded verbatim.
//
// Rows (the vertices of one domain) are ordered by cell; all rows of a cell share one index list, so the
// weights are one dense block a cell, stored row-major with `stride` floats a row, stride = list length rounded up
// to 4. Padding has weight 0 and repeats the list's last index, so a loop over the padded list is exact.
// Coefficients are the knots' control coefficients (lambda), then the source columns' values, one row of
// `channels` floats each. Rows that a diffusion curve fixes have weight 1 at their own knot and 0 elsewhere.
#pragma once

#include <cstdint>
#include <vector>

#include "pvg/status.h"

namespace pvg {

struct Table {
    std::uint32_t row_count = 0;          ///< R
    std::uint32_t cell_count = 0;         ///< N
    std::uint32_t coefficient_count = 0;  ///< knots + source columns
    std::uint32_t channels = 0;           ///< 1 (height), 4 (RGBA) or 5 (RGBA, height)

    std::vector<std::uint32_t> cell_first_row;  ///< N + 1, ascending, first 0, last R
    std::vector<std::uint32_t>
        cell_first_index;  ///< N + 1: list of cell c is indices[first[c] .. first[c + 1]), a multiple of 4 long
    std::vector<std::uint32_t> cell_first_weight;  ///< N + 1: block of cell c; rows x stride floats; multiples of 4
    std::vector<std::uint32_t> indices;            ///< < coefficient_count
    std::vector<float> weights;                    ///< finite

    std::vector<std::uint32_t> row_vertex;  ///< R: vertex of the domain of each row (a permutation)
    std::vector<std::uint32_t> vertex_row;  ///< the inverse

    std::uint64_t bytes() const;
};

/// Checks every invariant above. Returns an error naming the first one broken.
Result<bool> validate(const Table& table);

}  // namespace pvg
