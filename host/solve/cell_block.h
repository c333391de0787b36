// The table, cell by cell: what a basis computes before it becomes the evaluators' format.
#pragma once

#include <vector>

#include "pvg/table.h"
#include "solve/envelope.h"
#include "solve/patch_space.h"

namespace pvg {

/// A cell's block of the table.
struct CellBlock {
    std::vector<int> list;  ///< coefficients: knots, then knots.size() + source; not empty
    RowMatrix weights;      ///< vertices of the cell, in the order of PatchSpace::cell_vertices, x list
};

/// The table over the space's knots and sources from one block a cell, in their order. Vertices without faces get rows of zeros.
Table table_of_blocks(const PatchSpace& space, const std::vector<CellBlock>& blocks);

}  // namespace pvg
