#include "solve/galerkin_matrix.h"

#include <algorithm>
#include <utility>

#include "mesh/surface.h"
#include "solve/parallel.h"

namespace pvg {
namespace {

/// Which cells list a coefficient, and where.
struct Listed {
    std::vector<std::size_t> first;          // coefficients + 1
    std::vector<std::pair<int, int>> where;  // (cell, place in its list), by cell
};

Listed cells_of_knots(const Table& table, int knots) {
    Listed listed;
    listed.first.assign(static_cast<std::size_t>(knots) + 1, 0);
    const auto each = [&](const auto& visit) {
        for (std::uint32_t c = 0; c < table.cell_count; ++c) {
            const std::uint32_t begin = table.cell_first_index[c], length = table.cell_first_index[c + 1] - begin;
            for (std::uint32_t k = 0; k < length; ++k) {
                const std::uint32_t coefficient = table.indices[begin + k];
                const bool padding = k > 0 && coefficient == table.indices[begin + k - 1];
                if (!padding && coefficient < static_cast<std::uint32_t>(knots))
                    visit(static_cast<int>(c), static_cast<int>(k), static_cast<int>(coefficient));
            }
        }
    };
    each([&](int, int, int knot) { ++listed.first[static_cast<std::size_t>(knot) + 1]; });
    for (int j = 0; j < knots; ++j) listed.first[j + 1] += listed.first[j];
    listed.where.resize(listed.first.back());
    std::vector<std::size_t> end(listed.first.begin(), listed.first.end() - 1);
    each([&](int cell, int place, int knot) { listed.where[end[knot]++] = {cell, place}; });
    return listed;
}

/// One row of (A | B) after another: y = S psi_k on the vertices, then y^T (Psi | Beta) cell by cell.
class RowMaker {
public:
    struct Row {
        std::vector<std::pair<int, double>> knots, sources;
    };

    RowMaker(const EnergyForm& form, const Table& table, const Listed& listed, const std::vector<int>& cell_of_row, int knots)
        : form_(form),
          table_(table),
          listed_(listed),
          cell_of_row_(cell_of_row),
          knots_(knots),
          y_(table.row_count, 0.0),
          sum_(table.coefficient_count, 0.0),
          touched_(table.cell_count, 0),
          summed_(table.coefficient_count, 0) {}

    void make(int knot, Row& row) {
        cells_.clear();
        coefficients_.clear();
        row.knots.clear();
        row.sources.clear();
        for (std::size_t i = listed_.first[knot]; i < listed_.first[knot + 1]; ++i)
            spread(listed_.where[i].first, listed_.where[i].second);
        for (int cell : cells_) gather(cell);
        std::sort(coefficients_.begin(), coefficients_.end());
        for (int j : coefficients_) {
            if (j < knots_)
                row.knots.emplace_back(j, sum_[j]);
            else
                row.sources.emplace_back(j - knots_, sum_[j]);
            sum_[j] = 0;
            summed_[j] = 0;
        }
    }

private:
    /// y += S psi for the part of psi in one cell, and its loads.
    void spread(int cell, int place) {
        const std::uint32_t begin = table_.cell_first_row[cell], end = table_.cell_first_row[cell + 1];
        const std::uint32_t stride = table_.cell_first_index[cell + 1] - table_.cell_first_index[cell];
        const float* weight = table_.weights.data() + table_.cell_first_weight[cell] + place;
        for (std::uint32_t r = begin; r < end; ++r, weight += stride) {
            const double psi = *weight;
            if (psi == 0)
                continue;
            const int vertex = static_cast<int>(table_.row_vertex[r]);
            for (Eigen::SparseMatrix<double>::InnerIterator it(form_.S, vertex); it; ++it) {
                const std::uint32_t row = table_.vertex_row[it.row()];
                y_[row] += psi * it.value();
                const int other = cell_of_row_[row];
                if (!touched_[other]) {
                    touched_[other] = 1;
                    cells_.push_back(other);
                }
            }
            for (int i = form_.load_first[vertex]; i < form_.load_first[vertex + 1]; ++i)
                add(knots_ + form_.loads[i].first, psi * form_.loads[i].second);
        }
    }

    void gather(int cell) {
        touched_[cell] = 0;
        const std::uint32_t begin = table_.cell_first_row[cell], end = table_.cell_first_row[cell + 1];
        const std::uint32_t list = table_.cell_first_index[cell], stride = table_.cell_first_index[cell + 1] - list;
        const float* weight = table_.weights.data() + table_.cell_first_weight[cell];
        part_.assign(stride, 0.0);
        for (std::uint32_t r = begin; r < end; ++r, weight += stride) {
            const double y = y_[r];
            y_[r] = 0;
            if (y != 0)
                for (std::uint32_t k = 0; k < stride; ++k) part_[k] += y * double{weight[k]};
        }
        for (std::uint32_t k = 0; k < stride; ++k) add(static_cast<int>(table_.indices[list + k]), part_[k]);
    }

    void add(int coefficient, double value) {
        sum_[coefficient] += value;
        if (!summed_[coefficient]) {
            summed_[coefficient] = 1;
            coefficients_.push_back(coefficient);
        }
    }

    const EnergyForm& form_;
    const Table& table_;
    const Listed& listed_;
    const std::vector<int>& cell_of_row_;
    int knots_;
    std::vector<double> y_;    // by row of the table
    std::vector<double> sum_;  // by coefficient
    std::vector<char> touched_, summed_;
    std::vector<int> cells_, coefficients_;
    std::vector<double> part_;
};

SparseRows concatenated(std::vector<SparseRows>& parts) {
    SparseRows all;
    std::size_t rows = 0, entries = 0;
    for (const SparseRows& part : parts) {
        rows += part.first.size() - 1;
        entries += part.column.size();
    }
    all.first.reserve(rows + 1);
    all.column.reserve(entries);
    all.value.reserve(entries);
    for (SparseRows& part : parts) {
        for (std::size_t i = 1; i < part.first.size(); ++i) all.first.push_back(all.column.size() + part.first[i]);
        all.column.insert(all.column.end(), part.column.begin(), part.column.end());
        all.value.insert(all.value.end(), part.value.begin(), part.value.end());
        part = {};
    }
    return all;
}

template <int channels>
void multiply_rows(const SparseRows& M, const KnotValues& x, KnotValues& y, int begin, int end) {
    const Eigen::Index width = channels > 0 ? channels : x.cols();
    const double* const from = x.data();
    for (int i = begin; i < end; ++i) {
        double* const out = y.data() + i * width;
        if constexpr (channels > 0) {
            Eigen::Array<double, channels, 1> sum = Eigen::Array<double, channels, 1>::Zero();
            for (std::size_t e = M.first[i]; e < M.first[i + 1]; ++e)
                sum += M.value[e] * Eigen::Map<const Eigen::Array<double, channels, 1>>(from + M.column[e] * width);
            Eigen::Map<Eigen::Array<double, channels, 1>>{out} = sum;
        } else {
            std::fill_n(out, width, 0.0);
            for (std::size_t e = M.first[i]; e < M.first[i + 1]; ++e)
                for (Eigen::Index c = 0; c < width; ++c) out[c] += M.value[e] * from[M.column[e] * width + c];
        }
    }
}

}  // namespace

GalerkinMatrix galerkin_matrix(const EnergyForm& form, const Table& table, int knots, int threads) {
    std::vector<int> cell_of_row(table.row_count);
    for (std::uint32_t c = 0; c < table.cell_count; ++c)
        std::fill(cell_of_row.begin() + table.cell_first_row[c], cell_of_row.begin() + table.cell_first_row[c + 1],
                  static_cast<int>(c));
    const Listed listed = cells_of_knots(table, knots);
    constexpr int chunk = 256;
    const int chunks = (knots + chunk - 1) / chunk, workers = thread_count(threads, chunks);
    std::vector<RowMaker> makers(workers, RowMaker(form, table, listed, cell_of_row, knots));
    std::vector<RowMaker::Row> rows(workers);
    std::vector<SparseRows> A(chunks), B(chunks);
    const auto append = [](SparseRows& to, const std::vector<std::pair<int, double>>& row) {
        for (const auto& [column, value] : row) {
            to.column.push_back(column);
            to.value.push_back(value);
        }
        to.first.push_back(to.column.size());
    };
    for_each_parallel(chunks, workers, [&](int worker, int i) {
        for (int k = i * chunk; k < std::min(knots, (i + 1) * chunk); ++k) {
            makers[worker].make(k, rows[worker]);
            append(A[i], rows[worker].knots);
            append(B[i], rows[worker].sources);
        }
    });
    return {concatenated(A), concatenated(B)};
}

void multiply(const SparseRows& M, const KnotValues& x, KnotValues& y, int threads) {
    y.resize(M.rows(), x.cols());
    constexpr int chunk = 2048;
    const int chunks = (M.rows() + chunk - 1) / chunk;
    const auto work = [&](int, int i) {
        const int begin = i * chunk, end = std::min(M.rows(), begin + chunk);
        switch (x.cols()) {
            case 1:
                return multiply_rows<1>(M, x, y, begin, end);
            case 4:
                return multiply_rows<4>(M, x, y, begin, end);
            case 5:
                return multiply_rows<5>(M, x, y, begin, end);
            case 8:
                return multiply_rows<8>(M, x, y, begin, end);
            default:
                return multiply_rows<0>(M, x, y, begin, end);
        }
    };
    // A thread costs about as much as a chunk.
    for_each_parallel(chunks, std::min(thread_count(threads, chunks), chunks / 2 + 1), work);
}

}  // namespace pvg
