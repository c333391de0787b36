#include "solve/system.h"

#include <algorithm>
#include <numeric>
#include <string>

#include <Eigen/SparseCholesky>

#include "pvg/status.h"

namespace pvg {

using SparseMatrix = Eigen::SparseMatrix<double>;

struct System::State {
    std::vector<int> vertex;          // N: of each knot
    std::vector<int> representative;  // N: the knot whose value this one shares, up to jumps
    std::vector<int> unknown;         // N: number of the representative's unknown, or none (fixed, or unreached: 0)
    std::vector<int> jump_order;      // couplings such that each right knot's chain is resolved before its left one
    SparseMatrix K;                   // N x N
    SparseMatrix load;                // N x sources: integral of the profile over each cell
    Eigen::SimplicialLDLT<SparseMatrix> factor;
    int unknowns = 0;
};

namespace {

/// Union-find over knots.
class Parts {
public:
    explicit Parts(int count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
    int find(int i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void join(int a, int b) {
        a = find(a);
        b = find(b);
        if (a != b)
            parent_[std::max(a, b)] = std::min(a, b);
    }

private:
    std::vector<int> parent_;
};

int knot_at(const Knots& knots, int vertex) {
    const int knot = knots.knot_of_vertex[vertex];
    if (knot == none)
        throw Error(ErrorKind::bad_input,
                    "system: vertex " + std::to_string(vertex) + " carries a value or a jump but is no knot");
    return knot;
}

SparseMatrix stiffness(const Voronoi& voronoi, int n) {
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(4 * voronoi.edges.size());
    for (const CellEdge& edge : voronoi.edges) {
        entries.emplace_back(edge.a, edge.a, edge.weight);
        entries.emplace_back(edge.b, edge.b, edge.weight);
        entries.emplace_back(edge.a, edge.b, -edge.weight);
        entries.emplace_back(edge.b, edge.a, -edge.weight);
    }
    SparseMatrix K(n, n);
    K.setFromTriplets(entries.begin(), entries.end());
    return K;
}

SparseMatrix loads(const Domain& domain, const Voronoi& voronoi, int n) {
    std::vector<std::size_t> first(domain.surface.face_count() + 1, voronoi.pieces.size());
    for (std::size_t i = voronoi.pieces.size(); i-- > 0;) first[voronoi.pieces[i].face] = i;
    for (std::size_t f = first.size() - 1; f-- > 0;) first[f] = std::min(first[f], first[f + 1]);
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t k = 0; k < domain.sources.size(); ++k)
        for (const auto& [face, value] : domain.sources[k].profile)
            for (std::size_t i = first[face]; i < first[face + 1]; ++i)
                entries.emplace_back(voronoi.pieces[i].cell, static_cast<int>(k), voronoi.pieces[i].area * value);
    SparseMatrix load(n, static_cast<int>(domain.sources.size()));
    load.setFromTriplets(entries.begin(), entries.end());
    return load;
}

}  // namespace

System::System(const Domain& domain, const Knots& knots, const Voronoi& voronoi) : state_(std::make_unique<State>()) {
    State& s = *state_;
    const int n = static_cast<int>(knots.vertex.size());
    s.vertex = knots.vertex;
    s.K = stiffness(voronoi, n);
    s.load = loads(domain, voronoi, n);

    for (int v = 0; v < domain.surface.vertex_count(); ++v)
        if (domain.dirichlet[v] && domain.surface.outgoing(v) != none)
            knot_at(knots, v);

    // Each left knot follows its right one; chains end at a knot that follows none.
    std::vector<int> follows(n, none), coupling_of(n, none);
    for (std::size_t c = 0; c < domain.couplings.size(); ++c) {
        const int left = knot_at(knots, domain.couplings[c].left), right = knot_at(knots, domain.couplings[c].right);
        if (left == right || domain.dirichlet[knots.vertex[left]])
            continue;  // a tip; a fixed value wins
        if (follows[left] != none)
            throw Error(ErrorKind::bad_input,
                        "system: vertex " + std::to_string(domain.couplings[c].left) + " is the left copy of two couplings");
        follows[left] = right;
        coupling_of[left] = static_cast<int>(c);
    }
    s.representative.resize(n);
    std::vector<std::pair<int, int>> depth_and_knot;
    for (int j = 0; j < n; ++j) {
        int at = j, depth = 0;
        while (follows[at] != none) {
            at = follows[at];
            if (++depth > n)
                throw Error(ErrorKind::bad_input,
                            "system: the couplings of vertex " + std::to_string(knots.vertex[j]) + " form a ring");
        }
        s.representative[j] = at;
        if (depth > 0)
            depth_and_knot.push_back({depth, j});
    }
    std::sort(depth_and_knot.begin(), depth_and_knot.end());
    for (const auto& [depth, knot] : depth_and_knot) s.jump_order.push_back(coupling_of[knot]);

    Parts parts(n);
    for (const CellEdge& edge : voronoi.edges)
        if (edge.weight > 0)
            parts.join(edge.a, edge.b);
    for (int j = 0; j < n; ++j) parts.join(j, s.representative[j]);
    std::vector<char> reached(n, 0);  // by part: has a Dirichlet value
    for (int j = 0; j < n; ++j)
        if (domain.dirichlet[knots.vertex[j]])
            reached[parts.find(j)] = 1;
    for (int k = 0; k < s.load.outerSize(); ++k)
        for (SparseMatrix::InnerIterator it(s.load, k); it; ++it)
            if (it.value() != 0 && !reached[parts.find(static_cast<int>(it.row()))])
                throw Error(
                    ErrorKind::bad_input,
                    domain.sources[k].primitive + ": the part of the surface that it lies on needs at least one diffusion curve");
    for (const Coupling& coupling : domain.couplings)
        if (!coupling.jump.isZero(0) && !reached[parts.find(knots.knot_of_vertex[coupling.left])])
            throw Error(ErrorKind::bad_input, "a Poisson curve jumps at vertex " + std::to_string(coupling.left) +
                                                  " in a part of the surface that needs at least one diffusion curve");

    s.unknown.assign(n, none);
    for (int j = 0; j < n; ++j)
        if (s.representative[j] == j && !domain.dirichlet[knots.vertex[j]] && reached[parts.find(j)])
            s.unknown[j] = s.unknowns++;
    for (int j = 0; j < n; ++j) s.unknown[j] = s.unknown[s.representative[j]];

    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(s.K.nonZeros());
    for (int column = 0; column < s.K.outerSize(); ++column)
        for (SparseMatrix::InnerIterator it(s.K, column); it; ++it) {
            const int i = s.unknown[it.row()], j = s.unknown[column];
            if (i != none && j != none)
                entries.emplace_back(i, j, it.value());
        }
    SparseMatrix reduced(s.unknowns, s.unknowns);
    reduced.setFromTriplets(entries.begin(), entries.end());
    if (s.unknowns == 0)
        return;
    s.factor.compute(reduced);
    if (s.factor.info() != Eigen::Success)
        throw Error(ErrorKind::bad_input, "system: the matrix of " + std::to_string(s.unknowns) +
                                              " control coefficients is singular; the surface is too badly triangulated");
}

System::~System() = default;
System::System(System&&) noexcept = default;
System& System::operator=(System&&) noexcept = default;

int System::unknowns() const { return state_->unknowns; }

Eigen::MatrixXd System::solve(const Domain& domain) const { return solve(domain, given_values(domain, state_->vertex)); }

Eigen::MatrixXd System::solve(const Domain& domain, const GivenValues& given) const {
    const State& s = *state_;
    const int n = static_cast<int>(s.vertex.size());
    // What is known: fixed values, and jumps against the representative.
    Eigen::MatrixXd lambda = given.fixed;
    std::vector<int> knot_of(domain.surface.vertex_count(), none);
    for (int j = 0; j < n; ++j) knot_of[s.vertex[j]] = j;
    for (int c : s.jump_order)
        lambda.row(knot_of[domain.couplings[c].left]) = lambda.row(knot_of[domain.couplings[c].right]) + given.jump.row(c);
    if (s.unknowns == 0)
        return lambda;

    Eigen::MatrixXd residual = -(s.K * lambda);
    if (given.source.rows() > 0)
        residual -= s.load * given.source;
    lambda += apply_inverse(residual);
    if (!lambda.allFinite())
        throw Error(ErrorKind::bad_input, "system: the control coefficients are not finite");
    return lambda;
}

Eigen::MatrixXd System::apply_inverse(const Eigen::MatrixXd& residual) const {
    const State& s = *state_;
    Eigen::MatrixXd change = Eigen::MatrixXd::Zero(residual.rows(), residual.cols());
    if (s.unknowns == 0)
        return change;
    Eigen::MatrixXd right = Eigen::MatrixXd::Zero(s.unknowns, residual.cols());
    for (Eigen::Index j = 0; j < residual.rows(); ++j)
        if (s.unknown[j] != none)
            right.row(s.unknown[j]) += residual.row(j);
    const Eigen::MatrixXd solution = s.factor.solve(right);
    for (Eigen::Index j = 0; j < residual.rows(); ++j)
        if (s.unknown[j] != none)
            change.row(j) = solution.row(s.unknown[j]);
    return change;
}

}  // namespace pvg
