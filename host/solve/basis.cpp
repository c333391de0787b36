#include "solve/basis.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

namespace pvg {
namespace {

/// A cell's block of the table.
struct CellBlock {
    std::vector<int> list;
    RowMatrix weights;  ///< vertices of the cell x list
};

/// Calls work(thread, item) for every item on threads of its own. Which thread takes an item is open; results may not depend on
/// it.
template <typename Work>
void for_each_parallel(int count, int threads, const Work& work) {
    std::atomic<int> next{0};
    std::exception_ptr failure;
    std::mutex failure_lock;
    const auto run = [&](int thread) {
        try {
            for (int item = next++; item < count; item = next++) work(thread, item);
        } catch (...) {
            const std::lock_guard lock(failure_lock);
            if (!failure)
                failure = std::current_exception();
            next = count;
        }
    };
    {
        std::vector<std::jthread> others;
        for (int t = 1; t < threads; ++t) others.emplace_back(run, t);
        run(0);
    }
    if (failure)
        std::rethrow_exception(failure);
}

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
    Table assemble(const std::vector<CellBlock>& blocks) const;

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

Table BasisBuilder::assemble(const std::vector<CellBlock>& blocks) const {
    Table table;
    const int vertices = domain_.surface.vertex_count();
    table.row_count = static_cast<std::uint32_t>(vertices);
    table.cell_count = static_cast<std::uint32_t>(cells());
    table.coefficient_count = static_cast<std::uint32_t>(knots_.vertex.size() + domain_.sources.size());
    table.channels = static_cast<std::uint32_t>(domain_.channels);
    table.cell_first_row.push_back(0);
    table.cell_first_index.push_back(0);
    table.cell_first_weight.push_back(0);
    std::vector<char> has_row(vertices, 0);
    for (int c = 0; c < cells(); ++c) {
        const CellBlock& block = blocks[c];
        for (int i = space_.cell_first[c]; i < space_.cell_first[c + 1]; ++i) {
            table.row_vertex.push_back(static_cast<std::uint32_t>(space_.cell_vertices[i]));
            has_row[space_.cell_vertices[i]] = 1;
        }
        const std::size_t stride = (block.list.size() + 3) / 4 * 4;
        for (std::size_t e = 0; e < stride; ++e)
            table.indices.push_back(static_cast<std::uint32_t>(block.list[std::min(e, block.list.size() - 1)]));
        for (Eigen::Index i = 0; i < block.weights.rows(); ++i) {
            for (Eigen::Index e = 0; e < block.weights.cols(); ++e)
                table.weights.push_back(static_cast<float>(block.weights(i, e)));
            table.weights.insert(table.weights.end(), stride - block.list.size(), 0.0f);
        }
        if (c + 1 == cells())  // vertices without faces: rows of zeros in the last cell, so that rows stay a permutation
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

}  // namespace

Table local_basis(const PatchSpace& space, const BasisOptions& options, const BasisTuning& tuning) {
    const BasisBuilder builder(space, tuning);
    const int cells = builder.cells();
    int threads = options.threads > 0 ? options.threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    threads = std::max(1, std::min(threads, cells));

    std::vector<PatchSolver> solvers;
    std::vector<Patch> patches(threads);
    for (int t = 0; t < threads; ++t) solvers.push_back(builder.new_solver());
    std::vector<CellBlock> blocks(cells);
    for_each_parallel(cells, threads,
                      [&](int thread, int cell) { blocks[cell] = builder.solve_cell(cell, solvers[thread], patches[thread]); });
    return builder.assemble(blocks);
}

Table local_basis(const PatchSpace& space, const BasisOptions& options) {
    BasisTuning tuning;
    tuning.patch.rings = options.rings;
    return local_basis(space, options, tuning);
}

}  // namespace pvg
