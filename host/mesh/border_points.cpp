#include "mesh/border_points.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace pvg {
namespace {

int next(int halfedge) { return Surface::next(halfedge); }
int prev(int halfedge) { return Surface::prev(halfedge); }

/// Right angles that rounding made obtuse do not count.
constexpr double tolerance = 1e-9;

/// Where along a border halfedge the triangle's third corner stands.
struct Foot {
    double at = 0;      // from the halfedge's origin
    double height = 0;  // of the corner over it
};

Foot foot_of(const IntrinsicTriangulation& triangulation, int h) {
    const auto& length = triangulation.lengths[h / 3];
    const double side = length[h % 3], far = length[next(h) % 3], near = length[prev(h) % 3];
    const double at = 0.5 * (side + (near - far) * (near + far) / side);
    // A corner on the edge itself gets a height that rounding does not lose.
    return {at, std::max(2 * triangle_area(length) / side, 1e-10 * side)};
}

class Splitter {
public:
    Splitter(IntrinsicTriangulation& triangulation, const Surface& surface, const BorderConditions& border)
        : triangulation_(triangulation), border_(border), vertices_(surface.vertex_count()) {
        other_side_ = border.other_side;
        other_side_.resize(vertices_, none);
        edge_from_.resize(vertices_);
        edge_to_.assign(vertices_, none);
        share_.assign(vertices_, 0);
        edge_length_.assign(vertices_, 0);
        halfedge_.assign(vertices_, none);
        for (int h = 0; h < surface.halfedge_count(); ++h) {
            if (surface.twin(h) != none)
                continue;
            const int v = surface.origin(h);
            edge_from_[v] = v;
            edge_to_[v] = surface.target(h);
            edge_length_[v] = surface.length(h);
            ++borders_;
        }
    }

    std::vector<BorderPoint> run() {
        std::vector<int> changed(triangulation_.twin.size());
        for (std::size_t h = 0; h < changed.size(); ++h) changed[h] = static_cast<int>(h);
        while (true) {
            make_delaunay(triangulation_, changed);
            find_border();
            const std::vector<std::pair<int, double>> places = places_to_split();
            if (places.empty() || points_.size() + places.size() > 8 * borders_)
                return std::move(points_);
            changed.clear();
            for (const auto& [v, at] : places) split(v, at, changed);
        }
    }

private:
    void find_border() {
        for (int h = 0; h < static_cast<int>(triangulation_.twin.size()); ++h)
            if (triangulation_.twin[h] == none)
                halfedge_[triangulation_.faces[h / 3][h % 3]] = h;
    }
    bool fixed(int v) const { return v < vertices_ && !border_.fixed.empty() && border_.fixed[v]; }

    /// (origin of a border edge, distance from it), one of the two sides of a Poisson curve.
    std::vector<std::pair<int, double>> places_to_split() const {
        std::vector<std::pair<int, double>> places;
        for (int v = 0; v < static_cast<int>(halfedge_.size()); ++v) {
            const int h = halfedge_[v];
            if (h == none || (fixed(edge_from_[v]) && fixed(edge_to_[v]) && other_side_[v] == none))
                continue;
            const OppositeAngle angle = opposite_angle(triangulation_, h);
            const int other = other_side_[v];
            if (other == none) {
                if (angle.cosine < -tolerance * angle.scale)
                    places.emplace_back(v, foot_of(triangulation_, h).at);
                continue;
            }
            const OppositeAngle beyond = opposite_angle(triangulation_, halfedge_[other]);
            const double sum = angle.sine * beyond.cosine + angle.cosine * beyond.sine;
            if (sum >= -tolerance * angle.scale * beyond.scale)
                continue;
            // The side with the larger angle decides; of two equal ones the first.
            const double mine = angle.cosine / angle.scale, theirs = beyond.cosine / beyond.scale;
            if (mine < theirs || (mine == theirs && v < other))
                places.emplace_back(v, foot_of(triangulation_, h).at);
        }
        return places;
    }

    void split(int v, double at, std::vector<int>& changed) {
        const int h = halfedge_[v], other = other_side_[v];
        const double length = triangulation_.lengths[h / 3][h % 3];
        const int mine = split_side(v, at, changed);
        if (other == none)
            return;
        const int theirs = split_side(other, length - at, changed);
        other_side_[v] = theirs;
        other_side_[theirs] = v;
        other_side_[other] = mine;
        other_side_[mine] = other;
        points_[mine - vertices_].other = theirs - vertices_;
        points_[theirs - vertices_].other = mine - vertices_;
    }

    /// Triangle v, w, c becomes v, n, c and n, w, c. Returns n.
    int split_side(int v, double at, std::vector<int>& changed) {
        IntrinsicTriangulation& t = triangulation_;
        const int h = halfedge_[v], f = h / 3, g = static_cast<int>(t.faces.size());
        const int n = vertices_ + static_cast<int>(points_.size());
        const Foot foot = foot_of(t, h);
        const int w = t.faces[f][next(h) % 3], c = t.faces[f][prev(h) % 3];
        const double length = t.lengths[f][h % 3], wc = t.lengths[f][next(h) % 3], cv = t.lengths[f][prev(h) % 3];
        int beyond_wc = t.twin[next(h)], beyond_cv = t.twin[prev(h)];
        if (beyond_wc == prev(h))  // the two are glued to each other
            beyond_wc = 3 * f + 2, beyond_cv = 3 * g + 1;
        const double to_corner = std::hypot(at - foot.at, foot.height);
        t.faces[f] = {v, n, c};
        t.lengths[f] = {at, to_corner, cv};
        t.faces.push_back({n, w, c});
        t.lengths.push_back({length - at, wc, to_corner});
        t.twin.resize(t.twin.size() + 3);
        const auto join = [&](int a, int b) {
            t.twin[a] = b;
            if (b != none)
                t.twin[b] = a;
        };
        t.twin[3 * f] = t.twin[3 * g] = none;
        join(3 * f + 1, 3 * g + 2);
        join(3 * f + 2, beyond_cv);
        join(3 * g + 1, beyond_wc);
        for (int k = 0; k < 3; ++k) {
            changed.push_back(3 * f + k);
            changed.push_back(3 * g + k);
        }
        // Other border halfedges of the old triangle have moved.
        for (int i : {3 * f, 3 * f + 1, 3 * f + 2, 3 * g, 3 * g + 1, 3 * g + 2})
            if (t.twin[i] == none && t.faces[i / 3][i % 3] != n)
                halfedge_[t.faces[i / 3][i % 3]] = i;
        halfedge_.push_back(3 * g);
        other_side_.push_back(none);
        edge_from_.push_back(edge_from_[v]);
        edge_to_.push_back(edge_to_[v]);
        edge_length_.push_back(edge_length_[v]);
        share_.push_back(share_[v] + at / edge_length_[v]);
        points_.push_back({edge_from_[n], edge_to_[n], share_[n], none});
        return n;
    }

    IntrinsicTriangulation& triangulation_;
    const BorderConditions& border_;
    int vertices_;
    std::size_t borders_ = 0;
    // By the vertex that a border edge leaves; points appended.
    std::vector<int> halfedge_, other_side_, edge_from_, edge_to_;  // edge: of the surface, that it is a part of
    std::vector<double> share_, edge_length_;
    std::vector<BorderPoint> points_;
};

/// u on all vertices and points from the vertices and the free values q: (V + points) x (V + free values).
Eigen::SparseMatrix<double> prolongation(int vertices, const std::vector<BorderPoint>& points) {
    const int count = static_cast<int>(points.size());
    std::vector<Eigen::Triplet<double>> entries;
    std::vector<int> own(count, none);
    int columns = vertices;
    for (int v = 0; v < vertices; ++v) entries.emplace_back(v, v, 1.0);
    for (int p = 0; p < count; ++p) {
        const int other = points[p].other;
        if (other == none || other > p) {
            own[p] = columns++;
            entries.emplace_back(vertices + p, own[p], 1.0);
            continue;
        }
        // Across a jump the ends of the other side's edge run the other way.
        const BorderPoint &here = points[p], &there = points[other];
        entries.emplace_back(vertices + p, own[other], 1.0);
        entries.emplace_back(vertices + p, here.from, 1 - here.share);
        entries.emplace_back(vertices + p, there.to, -(1 - here.share));
        entries.emplace_back(vertices + p, here.to, here.share);
        entries.emplace_back(vertices + p, there.from, -here.share);
    }
    Eigen::SparseMatrix<double> P(vertices + count, columns);
    P.setFromTriplets(entries.begin(), entries.end());
    return P;
}

/// Schur complement on the first `keep` rows, one row after another; what it would add between two fixed ones is left out.
Eigen::SparseMatrix<double> eliminated(const Eigen::SparseMatrix<double>& S, int keep, const std::vector<char>& fixed) {
    const int count = static_cast<int>(S.cols()) - keep;
    const auto is_fixed = [&](int v) { return !fixed.empty() && fixed[v]; };
    std::vector<Eigen::Triplet<double>> entries;
    std::vector<std::map<int, double>> rows(count);
    for (int column = 0; column < S.outerSize(); ++column)
        for (Eigen::SparseMatrix<double>::InnerIterator it(S, column); it; ++it) {
            if (column >= keep)
                rows[column - keep][static_cast<int>(it.row())] = it.value();
            else if (it.row() < keep)
                entries.emplace_back(static_cast<int>(it.row()), column, it.value());
        }
    for (int q = 0; q < count; ++q) {
        // Of this row only later free values and kept vertices are left.
        std::vector<std::pair<int, double>> row;
        double pivot = 0;
        for (const auto& [i, value] : rows[q]) {
            if (i == keep + q)
                pivot = value;
            else if (i < keep || i > keep + q)
                row.emplace_back(i, value);
        }
        if (!(pivot > 0))
            continue;
        // Edges to q go away, edges among its neighbours come instead; diagonals follow, so that rows go on summing to 0.
        for (const auto& [i, a] : row) {
            if (i < keep)
                entries.emplace_back(i, i, a);
            for (const auto& [j, b] : row) {
                const double change = -a * b / pivot;
                if (j >= keep) {
                    rows[j - keep][i] += change;
                    if (i < keep)
                        entries.emplace_back(i, i, -change);
                } else if (i < j && !(is_fixed(i) && is_fixed(j))) {
                    entries.emplace_back(i, j, change);
                    entries.emplace_back(j, i, change);
                    entries.emplace_back(i, i, -change);
                    entries.emplace_back(j, j, -change);
                }
            }
        }
        rows[q].clear();
        for (const auto& [j, b] : row)
            if (j >= keep)
                rows[j - keep].erase(keep + q);
    }
    Eigen::SparseMatrix<double> result(keep, keep);
    result.setFromTriplets(entries.begin(), entries.end());
    return result;
}

/// Negative weights that act on nothing (between two given values) or are only rounding become 0; the entry stays.
void drop_idle_weights(Eigen::SparseMatrix<double>& S, const std::vector<char>& fixed) {
    constexpr double rounding = 1e-8;
    Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(S.rows());
    for (int column = 0; column < S.outerSize(); ++column)
        for (Eigen::SparseMatrix<double>::InnerIterator it(S, column); it; ++it) {
            const bool idle = !fixed.empty() && fixed[it.row()] && fixed[column];
            if (it.row() == column || it.value() <= 0 || !(idle || it.value() < rounding))
                continue;
            diagonal[column] += it.value();
            it.valueRef() = 0;
        }
    for (int column = 0; column < S.outerSize(); ++column)
        if (diagonal[column] != 0)
            S.coeffRef(column, column) += diagonal[column];
}

}  // namespace

std::vector<BorderPoint> insert_border_points(IntrinsicTriangulation& triangulation, const Surface& surface,
                                              const BorderConditions& border) {
    return Splitter(triangulation, surface, border).run();
}

Eigen::SparseMatrix<double> surface_stiffness(const Surface& surface, const BorderConditions& border) {
    const int vertices = surface.vertex_count();
    IntrinsicTriangulation triangulation = intrinsic_triangulation(surface);
    const std::vector<BorderPoint> points = insert_border_points(triangulation, surface, border);
    Eigen::SparseMatrix<double> S = cotan_stiffness(triangulation, vertices + static_cast<int>(points.size()));
    if (!points.empty()) {
        const Eigen::SparseMatrix<double> P = prolongation(vertices, points);
        const Eigen::SparseMatrix<double> reduced = P.transpose() * S * P;
        S = eliminated(reduced, vertices, border.fixed);
    }
    drop_idle_weights(S, border.fixed);
    return S;
}

}  // namespace pvg
