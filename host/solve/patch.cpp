#include "solve/patch.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <tuple>

namespace pvg {
namespace {

constexpr int waiting = -2;  // in the patch's cells, not yet reached by an edge

}  // namespace

PatchSolver::PatchSolver(const PatchSpace& space, const PatchOptions& options)
    : space_(space),
      options_(options),
      modes_(2 * options.degree + 1),
      local_(space.domain.surface.vertex_count(), none),
      ring_of_cell_(space.knots.vertex.size(), none) {}

void PatchSolver::solve(int cell, Patch& patch) {
    gather(cell);
    join_edges();
    space_.log_map.unfold(vertices_, local_, log_map_, place_);
    choose_list(patch);
    attach_dirichlet();
    number_unknowns();
    open_columns(patch);
    add_offsets();
    add_equations(patch);
    add_fluxes(patch);
    factor_.factor();
    factor_.solve(X_);
    read_rows(cell, patch);
}

/// The cells around and their vertices, as far as edges connect them to the knot.
void PatchSolver::gather(int cell) {
    for (int v : vertices_) local_[v] = none;
    for (int c : cells_) ring_of_cell_[c] = none;
    vertices_.clear();
    cells_.assign(1, cell);
    ring_of_cell_[cell] = 0;
    for (std::size_t at = 0; at < cells_.size(); ++at) {
        const int c = cells_[at];
        if (ring_of_cell_[c] == options_.rings + options_.outer_rings)
            break;
        for (int e = space_.neighbour_first[c]; e < space_.neighbour_first[c + 1]; ++e) {
            const int other = space_.neighbours[e];
            if (ring_of_cell_[other] != none)
                continue;
            ring_of_cell_[other] = ring_of_cell_[c] + 1;
            cells_.push_back(other);
        }
    }

    // A patch that is round answers more evenly than one that follows its outermost cells, and is a third smaller.
    const Surface& surface = space_.domain.surface;
    const Point& centre = surface.point(space_.knots.vertex[cell]);
    double farthest = 0;
    for (int c : cells_)
        if (ring_of_cell_[c] <= options_.rings)
            farthest = std::max(farthest, (surface.point(space_.knots.vertex[c]) - centre).norm());
    queue_.clear();
    for (int c : cells_)
        for (int i = space_.cell_first[c]; i < space_.cell_first[c + 1]; ++i) {
            if (ring_of_cell_[c] > options_.rings &&
                (surface.point(space_.cell_vertices[i]) - centre).norm() > options_.reach * farthest)
                continue;
            queue_.push_back(space_.cell_vertices[i]);
            local_[queue_.back()] = waiting;
        }
    const auto reach = [&](int v) {
        if (local_[v] != waiting)
            return;
        local_[v] = static_cast<int>(vertices_.size());
        vertices_.push_back(v);
    };
    local_[space_.knots.vertex[cell]] = waiting;
    reach(space_.knots.vertex[cell]);
    for (std::size_t at = 0; at < vertices_.size(); ++at) {
        const int v = vertices_[at];
        for (Eigen::SparseMatrix<double>::InnerIterator entry(space_.S, v); entry; ++entry) reach(static_cast<int>(entry.row()));
        // A sharp Poisson curve's copies come together, whatever cells they are in: S is without negative weights only where both
        // are one unknown.
        for (int copy = space_.partner[v]; copy != none && copy != v; copy = space_.partner[copy]) {
            if (local_[copy] == none)
                local_[copy] = waiting;
            reach(copy);
        }
    }
    for (int v : queue_)
        if (local_[v] == waiting)
            local_[v] = none;
}

void PatchSolver::join_edges() {
    edge_first_.assign(1, 0);
    edge_to_.clear();
    edge_weight_.clear();
    outer_.assign(vertices_.size(), 0);
    for (std::size_t v = 0; v < vertices_.size(); ++v) {
        for (Eigen::SparseMatrix<double>::InnerIterator entry(space_.S, vertices_[v]); entry; ++entry) {
            const int w = local_[entry.row()];
            if (w == none) {
                outer_[v] = 1;
            } else if (w != static_cast<int>(v)) {
                edge_to_.push_back(w);
                edge_weight_.push_back(-entry.value());
            }
        }
        edge_first_.push_back(static_cast<int>(edge_to_.size()));
    }
}

/// A Dirichlet vertex that is not listed takes the mean of the two nearest along the curve that are, by inverse distance: linear
/// between them. One that no curve joins to a listed one follows the nearest through the patch.
void PatchSolver::attach_dirichlet() {
    const int count = static_cast<int>(vertices_.size());
    anchors_.assign(count, {});
    has_dirichlet_ = false;
    using Entry = std::tuple<double, int, int>;  // distance, vertex, listed vertex
    std::vector<Entry> heap;
    const auto push = [&](double distance, int v, int a) {
        heap.emplace_back(distance, v, a);
        std::push_heap(heap.begin(), heap.end(), std::greater<>());
    };
    for (int v = 0; v < count; ++v) {
        if (!fixed(v))
            continue;
        has_dirichlet_ = true;
        if (entry_[v] != none)
            push(0, v, v);
    }
    anchored_ = !heap.empty();
    while (!heap.empty()) {
        std::pop_heap(heap.begin(), heap.end(), std::greater<>());
        const auto [distance, v, a] = heap.back();
        heap.pop_back();
        Anchors& at = anchors_[v];
        if (at.vertex[0] == a || at.vertex[1] != none || at.vertex[0] == v)
            continue;
        const int slot = at.vertex[0] == none ? 0 : 1;
        at.vertex[slot] = a;
        at.distance[slot] = distance;
        for (int e = edge_first_[v]; e < edge_first_[v + 1]; ++e)
            if (fixed(edge_to_[e]))
                push(distance + std::abs(place_[edge_to_[e]] - place_[v]), edge_to_[e], a);
    }
    if (!anchored_)
        return;
    queue_.clear();
    for (int v = 0; v < count; ++v)
        if (anchors_[v].vertex[0] != none)
            queue_.push_back(v);
    for (std::size_t i = 0; i < queue_.size(); ++i)
        for (int e = edge_first_[queue_[i]]; e < edge_first_[queue_[i] + 1]; ++e) {
            const int w = edge_to_[e];
            if (anchors_[w].vertex[0] != none)
                continue;
            anchors_[w].vertex[0] = anchors_[queue_[i]].vertex[0];
            queue_.push_back(w);
        }
}

/// One unknown a free vertex, the copies on sharp Poisson curves share one. Numbered by breadth from the far side of the
/// patch, backwards (reverse Cuthill-McKee without its sorting by degree, which meshes do not need).
void PatchSolver::number_unknowns() {
    const int count = static_cast<int>(vertices_.size());
    unknown_.assign(count, none);
    unknowns_ = 0;
    queue_.clear();
    const auto take = [&](int v) {
        if (unknown_[v] != none || fixed(v))
            return;
        unknown_[v] = unknowns_;
        queue_.push_back(v);
        const int root = right_of(v) == none ? v : right_of(v);
        for_copies(v, [&](int copy) {
            if (copy != root && right_of(copy) != root)
                return;
            unknown_[copy] = unknowns_;
            queue_.push_back(copy);
        });
        ++unknowns_;
    };
    std::size_t at = 0;
    for (int root = count - 1; root >= 0; --root)
        for (take(root); at < queue_.size(); ++at)
            for (int e = edge_first_[queue_[at]]; e < edge_first_[queue_[at] + 1]; ++e) take(edge_to_[e]);
    for (int& u : unknown_)
        if (u != none)
            u = unknowns_ - 1 - u;
    // Without a Dirichlet value the cell's knot is held; the constant is a mode of its own then.
    held_ = has_dirichlet_ || unknowns_ == 0 ? none : unknown_[0];

    first_column_.resize(unknowns_);
    for (int u = 0; u < unknowns_; ++u) first_column_[u] = u;
    for (int v = 0; v < count; ++v) {
        const int u = unknown_[v];
        if (u == none || u == held_)
            continue;
        for (int e = edge_first_[v]; e < edge_first_[v + 1]; ++e) {
            const int other = unknown_[edge_to_[e]];
            if (other != none && other != held_)
                first_column_[u] = std::min(first_column_[u], other);
        }
    }
    factor_.begin(first_column_);
}

/// Only list entries that stand for something known get a right-hand side: Dirichlet values, both sides of a jump, sources.
void PatchSolver::open_columns(const Patch& patch) {
    column_of_.assign(patch.list.size(), none);
    columns_ = 0;
    const auto open = [&](int entry) {
        if (column_of_[entry] == none)
            column_of_[entry] = columns_++;
    };
    for (int i = 0; i < patch.list_knots; ++i) {
        const int v = local_[patch.rows[i]];
        bool known = fixed(v);
        for_copies(v, [&](int copy) { known = known || entry_[copy] != none; });
        if (known)
            open(i);
    }
    for (std::size_t s = patch.list_knots; s < patch.list.size(); ++s) open(static_cast<int>(s));
    width_ = (columns_ + modes_ + 3) / 4 * 4;
    X_.setZero(unknowns_, width_);
}

void PatchSolver::polynomials(int v, double* values) const {
    const Complex z = place_[v] / scale_;
    Complex power = 1;
    values[0] = 1;
    for (int l = 1; l <= options_.degree; ++l) {
        power *= z;
        values[2 * l - 1] = power.real();
        values[2 * l] = power.imag();
    }
}

double* PatchSolver::new_offset(int v) {
    offset_of_[v] = offsets_++;
    offset_.resize(static_cast<std::size_t>(offsets_) * width_, 0.0);
    return offset_.data() + static_cast<std::size_t>(offset_of_[v]) * width_;
}

/// The patch's vertices before and behind on the border of the surface, not by the edges of S: where the border needed points,
/// those also join the two sides of a Poisson curve.
std::array<int, 2> PatchSolver::along_border(int v) const {
    const Surface& surface = space_.domain.surface;
    const int start = surface.outgoing(vertices_[v]);
    if (start == none || surface.twin(start) != none)
        return {none, none};
    int back = Surface::prev(start);
    while (surface.twin(back) != none) back = Surface::prev(surface.twin(back));
    return {local_[surface.target(start)], local_[surface.origin(back)]};
}

/// The listed copies of one vertex that lie on the same two sides of the curve as the copies left and right, as near along it as
/// there are any; none where no curve joins them.
std::pair<int, int> PatchSolver::listed_sides(int left, int right) {
    sides_.assign(1, {left, right});
    for (std::size_t at = 0; at < sides_.size(); ++at) {
        const auto [a, b] = sides_[at];
        if (entry_[a] != none && entry_[b] != none)
            return {a, b};
        const std::array<int, 2> beside_a = along_border(a), beside_b = along_border(b);
        for (const int next : beside_a) {
            if (next == none)
                continue;
            for_copies(next, [&](int copy) {
                const std::pair<int, int> pair(next, copy);
                if (std::find(beside_b.begin(), beside_b.end(), copy) != beside_b.end() &&
                    std::find(sides_.begin(), sides_.end(), pair) == sides_.end())
                    sides_.push_back(pair);
            });
        }
    }
    return {none, none};
}

/// What Dirichlet vertices and left copies are, apart from their unknown.
void PatchSolver::add_offsets() {
    const int count = static_cast<int>(vertices_.size());
    offset_of_.assign(count, none);
    offset_.clear();
    offsets_ = 0;
    std::vector<double> values(modes_);
    for (int v = 0; v < count; ++v) {
        if (!fixed(v))
            continue;
        double* const row = new_offset(v);
        const Anchors& at = anchors_[v];
        if (at.vertex[0] == v) {
            row[column_of_[entry_[v]]] = 1;
            continue;
        }
        // Beside the list the value follows the fitted polynomial from the listed vertices on: linear fields stay exact.
        polynomials(v, row + columns_);
        for (int k = 0; k < 2 && at.vertex[k] != none; ++k) {
            const double apart = at.distance[0] + at.distance[1];
            const double share = at.vertex[1] == none ? 1 : apart > 0 ? at.distance[1 - k] / apart : 0.5;
            row[column_of_[entry_[at.vertex[k]]]] += share;
            polynomials(at.vertex[k], values.data());
            for (int m = 0; m < modes_; ++m) row[columns_ + m] -= share * values[m];
        }
    }
    // Copies whose own knots are not both listed take the jump of the nearest along the curve that are. Which copy a coupling
    // calls left may change along a curve, so sides are followed, not names.
    for (int v = 0; v < count; ++v) {
        if (right_of(v) == none)
            continue;
        const auto [left, right] = listed_sides(v, right_of(v));
        if (left == none)
            continue;
        double* const row = new_offset(v);
        row[column_of_[entry_[left]]] = 1;
        row[column_of_[entry_[right]]] = -1;
    }
}

/// The patch's own stiffness (edges that leave it are dropped) and the loads.
void PatchSolver::add_equations(const Patch& patch) {
    const int knots = static_cast<int>(space_.knots.vertex.size());
    for (int v = 0; v < static_cast<int>(vertices_.size()); ++v) {
        const int u = unknown_[v];
        if (u == none)
            continue;
        double* const right = X_.row(u).data();
        const auto add_offset = [&](int of, double weight) {
            const double* const row = offset_.data() + static_cast<std::size_t>(offset_of_[of]) * width_;
            for (int k = 0; k < width_; ++k) right[k] += weight * row[k];
        };
        for (int e = edge_first_[v]; e < edge_first_[v + 1]; ++e) {
            const int w = edge_to_[e], other = unknown_[w];
            const double weight = edge_weight_[e];
            if (u != held_) {
                if (other != u)
                    factor_.add(u, u, weight);
                if (other != none && other != held_ && other < u)
                    factor_.add(u, other, -weight);
            }
            if (offset_of_[v] != none)
                add_offset(v, -weight);
            if (offset_of_[w] != none)
                add_offset(w, weight);
        }
        for (int i = space_.load_first[vertices_[v]]; i < space_.load_first[vertices_[v] + 1]; ++i) {
            const auto source =
                std::lower_bound(patch.list.begin() + patch.list_knots, patch.list.end(), knots + space_.loads[i].first);
            right[column_of_[source - patch.list.begin()]] -= space_.loads[i].second;
        }
    }
}

/// The flux that each polynomial sends through the outer border.
void PatchSolver::add_fluxes(const Patch&) {
    const int count = static_cast<int>(vertices_.size());
    std::vector<double> own(modes_), other(modes_);
    std::vector<double> outflow(count, 0.0);  // of the function |z|: where a flux that must leave does so
    double total = 0;
    for (int v = 0; v < count; ++v) {
        if (!outer_[v] || unknown_[v] == none)
            continue;
        double* const right = X_.row(unknown_[v]).data() + columns_;
        polynomials(v, own.data());
        for (int e = edge_first_[v]; e < edge_first_[v + 1]; ++e) {
            polynomials(edge_to_[e], other.data());
            for (int m = 1; m < modes_; ++m) right[m] += edge_weight_[e] * (own[m] - other[m]);
            outflow[v] += edge_weight_[e] * (std::abs(place_[v]) - std::abs(place_[edge_to_[e]]));
        }
        outflow[v] = std::max(outflow[v], 0.0);
        total += outflow[v];
    }
    if (total > 0 && has_dirichlet_ && anchored_) {
        // Mode 0: a flux that enters everywhere and ends on the diffusion curves. (Where none is listed, mode 0 is the constant
        // already.)
        for (int v = 0; v < count; ++v)
            if (outflow[v] > 0)
                X_(unknown_[v], columns_) += outflow[v] / total;
    } else if (total > 0 && !has_dirichlet_) {
        // A flux without a Dirichlet value to end on must sum to zero.
        const Eigen::RowVectorXd sum = X_.colwise().sum();
        for (int v = 0; v < count; ++v)
            if (outflow[v] > 0)
                X_.row(unknown_[v]) -= outflow[v] / total * sum;
    }
    if (held_ == none)
        return;
    factor_.add(held_, held_, 1);
    X_.row(held_).setZero();
}

void PatchSolver::read_rows(int cell, Patch& patch) const {
    const int listed = static_cast<int>(patch.list.size());
    for (int i = space_.cell_first[cell]; i < space_.cell_first[cell + 1]; ++i) {
        const int vertex = space_.cell_vertices[i];
        patch.rows.push_back(local_[vertex] == none ? none : vertex);
    }
    patch.free_constant = !anchored_;
    patch.known.setZero(static_cast<Eigen::Index>(patch.rows.size()), listed);
    patch.modes.setZero(static_cast<Eigen::Index>(patch.rows.size()), modes_);
    Eigen::RowVectorXd row(width_);
    for (std::size_t r = 0; r < patch.rows.size(); ++r) {
        if (patch.rows[r] == none)
            continue;
        const int v = local_[patch.rows[r]];
        row.setZero();
        if (unknown_[v] != none)
            row = X_.row(unknown_[v]);
        if (offset_of_[v] != none)
            row +=
                Eigen::Map<const Eigen::RowVectorXd>(offset_.data() + static_cast<std::size_t>(offset_of_[v]) * width_, width_);
        for (int e = 0; e < listed; ++e)
            if (column_of_[e] != none)
                patch.known(r, e) = row[column_of_[e]];
        patch.modes.row(r) = row.segment(columns_, modes_);
        if (!has_dirichlet_)
            patch.modes(r, 0) = 1;
    }
    patch.data.clear();
    patch.fixed.clear();
    for (int e = 0; e < patch.list_knots; ++e) {
        const int v = local_[patch.rows[e]];
        if (fixed(v))
            patch.fixed.push_back(e);
        else if (const int right = right_of(v); right == none || entry_[right] == none)  // tied copies say the same
            patch.data.push_back(e);
    }
    patch.polynomials.resize(static_cast<Eigen::Index>(patch.fixed.size()), modes_);
    for (std::size_t f = 0; f < patch.fixed.size(); ++f)
        polynomials(local_[patch.rows[patch.fixed[f]]], patch.polynomials.row(f).data());
}

}  // namespace pvg
