#include "solve/green_basis.h"

#include <algorithm>

#include "solve/cell_block.h"
#include "solve/parallel.h"

namespace pvg {

GreenBasis::GreenBasis(const PatchSpace& space, const Voronoi& voronoi) : space_(space), inverse_(space.domain.surface) {
    const int n = cells();
    neighbour_first_.assign(n + 1, 0);
    for (const CellEdge& edge : voronoi.edges) {
        ++neighbour_first_[edge.a + 1];
        ++neighbour_first_[edge.b + 1];
    }
    for (int c = 0; c < n; ++c) neighbour_first_[c + 1] += neighbour_first_[c];
    neighbours_.resize(neighbour_first_[n]);
    std::vector<int> fill(neighbour_first_.begin(), neighbour_first_.end() - 1);
    for (const CellEdge& edge : voronoi.edges) {
        neighbours_[fill[edge.a]++] = {edge.b, edge.weight};
        neighbours_[fill[edge.b]++] = {edge.a, edge.weight};
    }
    spread_charges(voronoi);
}

/// A piece of a cell gives each corner of its face a third of its area; in small cells, the cell's own corners all of it.
void GreenBasis::spread_charges(const Voronoi& voronoi) {
    const int n = cells();
    const Domain& domain = space_.domain;
    std::vector<double> area(n, 0);
    cell_weight_.assign(n, 0);
    std::vector<Eigen::Triplet<double>> entries;
    for (const CellPiece& piece : voronoi.pieces) area[piece.cell] += piece.area;
    for (const CellPiece& piece : voronoi.pieces) {
        if (point_charge(piece.cell) || !(area[piece.cell] > 0))
            continue;
        const double part = piece.area / area[piece.cell];
        const bool small = space_.cell_first[piece.cell + 1] - space_.cell_first[piece.cell] < 3;
        const auto takes_part = [&](int v) { return !small || voronoi.cell[v] == piece.cell; };
        const Face& face = domain.surface.face(piece.face);
        const auto corners = std::count_if(face.begin(), face.end(), takes_part);
        for (int v : face)
            if (takes_part(v))
                entries.emplace_back(v, piece.cell, part / static_cast<double>(corners));
        if (corners == 0)
            entries.emplace_back(space_.knots.vertex[piece.cell], piece.cell, part);
    }
    for (int c = 0; c < n; ++c)
        if (point_charge(c) || !(area[c] > 0))
            entries.emplace_back(space_.knots.vertex[c], c, 1.0);
    charge_.resize(domain.surface.vertex_count(), n);
    charge_.setFromTriplets(entries.begin(), entries.end());

    std::vector<double> component_area(inverse_.component_count(), 0);
    std::vector<int> component_cells(inverse_.component_count(), 0);
    for (int c = 0; c < n; ++c)
        if (const int component = inverse_.component(space_.knots.vertex[c]); component != none) {
            component_area[component] += area[c];
            ++component_cells[component];
        }
    for (int c = 0; c < n; ++c)
        if (const int component = inverse_.component(space_.knots.vertex[c]); component != none)
            cell_weight_[c] =
                component_area[component] > 0 ? area[c] / component_area[component] : 1.0 / component_cells[component];
}

/// At a slit's knot it is a flux that enters.
bool GreenBasis::point_charge(int cell) const { return on_slit(space_.knots.vertex[cell]); }

/// Adds amount * d_j.
void GreenBasis::add_charge(int cell, double amount, RowMatrix& columns, Eigen::Index column) const {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(charge_, cell); entry; ++entry)
        columns(entry.row(), column) += amount * entry.value();
}

/// Untruncated psi of the cells first .. first + count - 1 in the first columns; the width is rounded up to a multiple of 4.
void GreenBasis::fill_psi(int first, int count, RowMatrix& columns, RowMatrix& work) const {
    const int vertices = space_.domain.surface.vertex_count();
    columns.setZero(vertices, (count + 3) / 4 * 4);
    for (int k = 0; k < count; ++k) {
        const int cell = first + k;
        double sum = 0;
        for (int i = neighbour_first_[cell]; i < neighbour_first_[cell + 1]; ++i) {
            add_charge(neighbours_[i].cell, -neighbours_[i].weight, columns, k);
            sum += neighbours_[i].weight;
        }
        add_charge(cell, sum, columns, k);
    }
    inverse_.apply(columns, work);
    const RowMatrix means = knot_means(columns);
    for (int k = 0; k < count; ++k) {
        const int component = inverse_.component(space_.knots.vertex[first + k]);
        if (component == none)
            continue;
        const double shift = cell_weight_[first + k] - means(component, k);
        for (int v = 0; v < vertices; ++v)
            if (inverse_.component(v) == component)
                columns(v, k) += shift;
    }
}

/// Mean of the values at the knots, each counted with its cell's area: components x columns.
RowMatrix GreenBasis::knot_means(const RowMatrix& columns) const {
    RowMatrix means = RowMatrix::Zero(inverse_.component_count(), columns.cols());
    for (int c = 0; c < cells(); ++c) {
        const int knot = space_.knots.vertex[c], component = inverse_.component(knot);
        if (component != none)
            means.row(component) += cell_weight_[c] * columns.row(knot);
    }
    return means;
}

Eigen::MatrixXd GreenBasis::columns(int first, int count) const {
    RowMatrix columns, work;
    fill_psi(first, count, columns, work);
    return columns.leftCols(count);
}

Eigen::MatrixXd GreenBasis::sum(const Eigen::MatrixXd& lambda) const {
    const int n = cells(), vertices = space_.domain.surface.vertex_count();
    const Eigen::Index channels = lambda.cols();
    RowMatrix columns = RowMatrix::Zero(vertices, (channels + 3) / 4 * 4), work;
    RowMatrix mean = RowMatrix::Zero(inverse_.component_count(), channels);
    for (int c = 0; c < n; ++c) {
        Eigen::RowVectorXd flux = Eigen::RowVectorXd::Zero(channels);  // (K lambda)_c
        for (int i = neighbour_first_[c]; i < neighbour_first_[c + 1]; ++i)
            flux += neighbours_[i].weight * (lambda.row(c) - lambda.row(neighbours_[i].cell));
        for (Eigen::Index k = 0; k < channels; ++k)
            if (flux[k] != 0)
                add_charge(c, flux[k], columns, k);
        const int component = inverse_.component(space_.knots.vertex[c]);
        if (component != none)
            mean.row(component) += cell_weight_[c] * lambda.row(c);
    }
    inverse_.apply(columns, work);
    mean -= knot_means(columns).leftCols(channels);
    Eigen::MatrixXd u = columns.leftCols(channels);
    for (int v = 0; v < vertices; ++v)
        if (inverse_.component(v) != none)
            u.row(v) += mean.row(inverse_.component(v));
    return u;
}

/// The cell itself, then the others within `rings`, ascending. ring_of_cell: a buffer of N times none, left so.
std::vector<int> GreenBasis::cells_around(int cell, int rings, std::vector<int>& ring_of_cell) const {
    std::vector<int> list{cell};
    ring_of_cell[cell] = 0;
    for (std::size_t head = 0; head < list.size() && ring_of_cell[list[head]] < rings; ++head)
        for (int i = neighbour_first_[list[head]]; i < neighbour_first_[list[head] + 1]; ++i) {
            const int other = neighbours_[i].cell;
            if (ring_of_cell[other] != none)
                continue;
            ring_of_cell[other] = ring_of_cell[list[head]] + 1;
            list.push_back(other);
        }
    for (int c : list) ring_of_cell[c] = none;
    std::sort(list.begin() + 1, list.end());
    return list;
}

Table GreenBasis::table(const GreenOptions& options) const {
    const int n = cells();
    std::vector<CellBlock> blocks(n);
    std::vector<int> ring_of_cell(n, none);
    for (int c = 0; c < n; ++c) {
        blocks[c].list = cells_around(c, options.rings, ring_of_cell);
        blocks[c].weights.setZero(space_.cell_first[c + 1] - space_.cell_first[c],
                                  static_cast<Eigen::Index>(blocks[c].list.size()));
    }

    const int batch = std::max(1, options.batch), batches = (n + batch - 1) / batch;
    const int threads = thread_count(options.threads, batches);
    std::vector<RowMatrix> columns(threads), work(threads);
    std::atomic<int> done{0};
    for_each_parallel(batches, threads, [&](int thread, int item) {
        const int first = item * batch, count = std::min(batch, n - first);
        fill_psi(first, count, columns[thread], work[thread]);
        // "Within so many rings" holds both ways: psi of j stands in the lists of exactly the cells in the list of j.
        for (int k = 0; k < count; ++k)
            for (int c : blocks[first + k].list) {
                const std::vector<int>& list = blocks[c].list;
                const Eigen::Index at =
                    c == first + k ? 0 : std::lower_bound(list.begin() + 1, list.end(), first + k) - list.begin();
                for (int i = space_.cell_first[c]; i < space_.cell_first[c + 1]; ++i)
                    blocks[c].weights(i - space_.cell_first[c], at) = columns[thread](space_.cell_vertices[i], k);
            }
        ++done;
        if (thread == 0 && options.on_progress)
            options.on_progress(static_cast<double>(done) / batches);
    });

    // A row whose sum is farther from 1 than this has lost its meaning to truncation; its own knot is then the better answer.
    constexpr double factor = 2;
    for (int c = 0; c < n; ++c)
        for (int i = space_.cell_first[c]; i < space_.cell_first[c + 1]; ++i) {
            auto row = blocks[c].weights.row(i - space_.cell_first[c]);
            const int v = space_.cell_vertices[i];
            const bool fixed = on_slit(v);
            const double sum = row.sum();
            if (fixed || (options.normalize && !(sum > 1 / factor && sum < factor)))
                row = Eigen::RowVectorXd::Unit(row.size(), 0);
            else if (options.normalize)
                row /= sum;
        }
    return table_of_blocks(space_, blocks);
}

}  // namespace pvg
