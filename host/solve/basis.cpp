#include "solve/basis.h"

#include "solve/cell_block.h"
#include "solve/parallel.h"

namespace pvg {
namespace {

class BasisBuilder {
public:
    BasisBuilder(const PatchSpace& space, const BasisTuning& tuning)
        : domain_(space.domain), knots_(space.knots), space_(space), tuning_(tuning) {}

    int cells() const { return static_cast<int>(knots_.vertex.size()); }
    PatchSolver new_solver() const { return PatchSolver(space_, tuning_.patch); }

    /// Cells that evaluate their own knot only need no patch.
    bool needs_patch(int cell) const {
        const int begin = space_.cell_first[cell], count = space_.cell_first[cell + 1] - begin;
        if (count != 1 || space_.cell_vertices[begin] != knots_.vertex[cell])
            return count > 0;
        return !tuning_.exact_knots && !domain_.dirichlet[knots_.vertex[cell]];
    }

    CellBlock solve_cell(int cell, PatchSolver& solver, Patch& patch) const;

private:
    const Domain& domain_;
    const Knots& knots_;
    const PatchSpace& space_;
    BasisTuning tuning_;
};

CellBlock BasisBuilder::solve_cell(int cell, PatchSolver& solver, Patch& patch) const {
    CellBlock block;
    const int begin = space_.cell_first[cell], count = space_.cell_first[cell + 1] - begin;
    if (!needs_patch(cell)) {
        block.list.assign(1, cell);
        block.weights = RowMatrix::Ones(count, 1);
        return block;
    }
    solver.solve(cell, patch);
    block.list = patch.list;
    block.weights = fitted_rows(patch, tuning_.fit);
    for (int i = 0; i < count; ++i) {
        auto row = block.weights.row(i);
        const int vertex = patch.rows[patch.list_knots + i];
        if (vertex == none || domain_.dirichlet[vertex]) {
            // The knot itself (the list's first), or a vertex that no edge joins to it inside the patch.
            row.setZero();
            row[0] = 1;
        } else {
            row[0] += 1 - row.head(patch.list_knots).sum();  // rounding of long sums
        }
    }
    return block;
}

}  // namespace

Table local_basis(const PatchSpace& space, const BasisOptions& options, const BasisTuning& tuning) {
    const BasisBuilder builder(space, tuning);
    const int cells = builder.cells();
    const int threads = thread_count(options.threads, cells);

    std::vector<PatchSolver> solvers;
    std::vector<Patch> patches(threads);
    for (int t = 0; t < threads; ++t) solvers.push_back(builder.new_solver());
    std::vector<CellBlock> blocks(cells);
    for_each_parallel(cells, threads,
                      [&](int thread, int cell) { blocks[cell] = builder.solve_cell(cell, solvers[thread], patches[thread]); });
    return table_of_blocks(space, blocks);
}

Table local_basis(const PatchSpace& space, const BasisOptions& options) {
    BasisTuning tuning;
    tuning.patch.rings = options.rings;
    return local_basis(space, options, tuning);
}

}  // namespace pvg
