// Linear finite elements with cotangent weights. Source: U. Pinkall, K. Polthier, "Computing discrete minimal surfaces and
// their conjugates", 1993; constraints by elimination.
#include "cpu_reference/finite_elements.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <stdexcept>
#include <string>

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include "cpu_reference/border_refinement.h"

namespace pvg {
namespace {

using Matrix = Eigen::SparseMatrix<double>;

int channel_count(const FemProblem& problem) {
    if (problem.laplacian.cols() > 0)
        return static_cast<int>(problem.laplacian.cols());
    if (!problem.dirichlet.empty())
        return static_cast<int>(problem.dirichlet.front().second.size());
    return problem.jumps.empty() ? 0 : static_cast<int>(problem.jumps.front().value.size());
}

void check_problem(const FemProblem& problem) {
    const auto vertices = static_cast<int>(problem.points.size());
    const int channels = channel_count(problem);
    const auto require = [](bool holds, const char* what) {
        if (!holds)
            throw std::runtime_error(std::string("finite elements: ") + what);
    };
    const auto exists = [&](int v) { return v >= 0 && v < vertices; };
    for (const auto& face : problem.faces)
        require(std::all_of(face.begin(), face.end(), exists), "a face names a vertex that does not exist");
    for (const auto& [v, value] : problem.dirichlet) {
        require(exists(v), "a Dirichlet vertex does not exist");
        require(value.size() == channels, "a Dirichlet value has another number of channels");
    }
    for (const FemProblem::Jump& jump : problem.jumps) {
        require(exists(jump.left) && exists(jump.right), "a jump names a vertex that does not exist");
        require(jump.value.size() == channels, "a jump has another number of channels");
    }
    require(problem.laplacian.size() == 0 || problem.laplacian.rows() == static_cast<int>(problem.faces.size()),
            "laplacian needs one row a face");
}

double face_area(const FemProblem& problem, std::size_t f) {
    const auto& [a, b, c] = problem.faces[f];
    return 0.5 * (problem.points[b] - problem.points[a]).cross(problem.points[c] - problem.points[a]).norm();
}

/// Sets of vertices, each with an offset to its set's root: u(vertex) = u(root) + offset.
class OffsetSets {
public:
    OffsetSets(std::size_t count, int channels)
        : parent_(count), offset_(Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(count), channels)) {
        std::iota(parent_.begin(), parent_.end(), 0);
    }
    int root(int v) {
        std::vector<int> path;
        for (; parent_[v] != v; v = parent_[v]) path.push_back(v);
        // From the root outwards, so that every offset passed on is already one to the root.
        for (auto it = path.rbegin(); it != path.rend(); ++it) {
            if (parent_[*it] != v)
                offset_.row(*it) += offset_.row(parent_[*it]);
            parent_[*it] = v;
        }
        return v;
    }
    Eigen::RowVectorXd offset(int v) {
        const int r = root(v);
        return r == v ? Eigen::RowVectorXd::Zero(offset_.cols()).eval() : offset_.row(v).eval();
    }
    /// u(left) = u(right) + value; says nothing new when the two already hang together.
    void join(int left, int right, const Eigen::RowVectorXd& value) {
        const int a = root(left), b = root(right);
        if (a == b)
            return;
        offset_.row(a) = offset(right) + value - offset(left);
        parent_[a] = b;
    }

private:
    std::vector<int> parent_;
    Eigen::MatrixXd offset_;
};

/// Which border sides face each other across a jump, and which vertices are held. Banks of a seam have the same places in space;
/// one end at least hangs on its opposite by a jump; the other may be one vertex, or two held ones.
Border border_of(const FemProblem& problem, const LengthMesh& mesh) {
    Border border;
    border.held.resize(problem.points.size());
    for (const auto& dirichlet : problem.dirichlet) border.held[dirichlet.first] = true;
    if (problem.jumps.empty())
        return border;
    OffsetSets sets(problem.points.size(), 0);
    for (const FemProblem::Jump& jump : problem.jumps) sets.join(jump.left, jump.right, Eigen::RowVectorXd(0));
    using Place = std::array<double, 6>;
    const auto place = [&](int from, int to) {
        const auto &p = problem.points[from], &q = problem.points[to];
        return Place{p.x(), p.y(), p.z(), q.x(), q.y(), q.z()};
    };
    std::multimap<Place, Side> by_place;
    for (std::size_t f = 0; f < mesh.vertices.size(); ++f) {
        for (int k = 0; k < 3; ++k) {
            const int a = mesh.vertices[f][k], b = mesh.vertices[f][(k + 1) % 3];
            if (mesh.twins[f][k] < 0)
                by_place.emplace(place(a, b), Side{a, b});
        }
    }
    for (const auto& entry : by_place) {
        const auto [a, b] = entry.second;
        const auto [first, last] = by_place.equal_range(place(b, a));
        for (auto it = first; it != last; ++it) {
            const auto [c, d] = it->second;
            const bool a_joined = sets.root(a) == sets.root(d), b_joined = sets.root(b) == sets.root(c);
            const bool a_goes = a_joined || (border.held[a] && border.held[d]);
            const bool b_goes = b_joined || (border.held[b] && border.held[c]);
            if (a_goes && b_goes && ((a_joined && a != d) || (b_joined && b != c)))
                border.seams[{a, b}] = {c, d};
        }
    }
    return border;
}

/// The operator, with the free values of the points on the border as further unknowns: V given vertices, then those.
struct Elements {
    Matrix S;
    std::vector<int> carrier;  ///< per further unknown: a given vertex of the same component
};

Elements assemble(const FemProblem& problem, FemTriangulation triangulation) {
    const auto given = static_cast<int>(problem.points.size());
    LengthMesh mesh = make_length_mesh(problem.points, problem.faces);
    std::vector<AddedVertex> added;
    if (triangulation == FemTriangulation::intrinsic_delaunay)
        added = refine_border(mesh, border_of(problem, mesh));
    const int all = given + static_cast<int>(added.size());
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t f = 0; f < mesh.vertices.size(); ++f) {
        for (int k = 0; k < 3; ++k) {
            const int i = mesh.vertices[f][k], j = mesh.vertices[f][(k + 1) % 3];
            const double weight = 0.5 * opposite_cotangent(mesh.lengths[f], k);
            entries.emplace_back(i, i, weight);
            entries.emplace_back(j, j, weight);
            entries.emplace_back(i, j, -weight);
            entries.emplace_back(j, i, -weight);
        }
    }
    Elements elements;
    elements.S.resize(all, all);
    elements.S.setFromTriplets(entries.begin(), entries.end());
    if (added.empty())
        return elements;
    // Two banks of a seam have one free value; the jump between them is linear between the seam's given vertices.
    entries.clear();
    for (int v = 0; v < given; ++v) entries.emplace_back(v, v, 1.0);
    int unknowns = given;
    for (int n = given; n < all; ++n) {
        const AddedVertex& here = added[n - given];
        if (here.across > n)
            continue;
        elements.carrier.push_back(here.from);
        entries.emplace_back(n, unknowns, 1.0);
        if (here.across >= 0) {
            const AddedVertex& there = added[here.across - given];
            entries.emplace_back(here.across, unknowns, 1.0);
            const std::array<std::pair<int, double>, 4> jump{
                {{there.from, 1 - there.at}, {there.to, there.at}, {here.from, -(1 - here.at)}, {here.to, -here.at}}};
            for (const auto& [v, part] : jump) entries.emplace_back(here.across, v, part);
        }
        ++unknowns;
    }
    Matrix values(all, unknowns);
    values.setFromTriplets(entries.begin(), entries.end());
    elements.S = Matrix(values.transpose() * elements.S * values);
    return elements;
}

/// Energy of a field on the given vertices: the least over the border's free values.
class EnergyNorm {
public:
    EnergyNorm(const Matrix& S, Eigen::Index given)
        : outer_(S.topLeftCorner(given, given)), mixed_(S.bottomLeftCorner(S.rows() - given, given)) {
        if (mixed_.rows() == 0)
            return;
        factor_.compute(Matrix(S.bottomRightCorner(S.rows() - given, S.rows() - given)));
        if (factor_.info() != Eigen::Success)
            throw std::runtime_error("finite elements: the factorisation failed");
    }
    double operator()(const Eigen::VectorXd& v) const {
        double energy = v.dot(outer_ * v);
        if (mixed_.rows() > 0) {
            const Eigen::VectorXd pull = mixed_ * v;
            energy -= pull.dot(factor_.solve(pull));
        }
        return energy < 0 ? 0 : std::sqrt(energy);  // rounding may make 0 negative; what is not a number stays so
    }

private:
    Matrix outer_, mixed_;
    Eigen::SimplicialLDLT<Matrix> factor_;
};

/// For each vertex whether its component has a Dirichlet value.
std::vector<bool> reached_vertices(const FemProblem& problem) {
    OffsetSets components(problem.points.size(), 0);
    const Eigen::RowVectorXd nothing(0);
    for (const auto& face : problem.faces) {
        components.join(face[0], face[1], nothing);
        components.join(face[1], face[2], nothing);
    }
    for (const FemProblem::Jump& jump : problem.jumps) components.join(jump.left, jump.right, nothing);
    std::vector<bool> root_reached(problem.points.size()), reached(problem.points.size());
    for (const auto& dirichlet : problem.dirichlet) root_reached[components.root(dirichlet.first)] = true;
    for (std::size_t v = 0; v < reached.size(); ++v) reached[v] = root_reached[components.root(static_cast<int>(v))];
    return reached;
}

/// Ranges below this part of what the field's magnitude could make are rounding of a constant.
constexpr double rounding = 1e-9;

/// What errors of a channel are measured against.
struct Scale {
    double range = 0;    ///< or `largest`, where the field is constant
    double largest = 0;  ///< magnitude
};

Scale scale_of(const Eigen::VectorXd& truth, const std::vector<bool>& reached) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t v = 0; v < reached.size(); ++v) {
        if (!reached[v])
            continue;
        low = std::min(low, truth[static_cast<Eigen::Index>(v)]);
        high = std::max(high, truth[static_cast<Eigen::Index>(v)]);
    }
    if (!(low <= high))
        return {};
    const double largest = std::max(std::abs(low), std::abs(high));
    return {high - low < rounding * largest ? largest : high - low, largest};
}

}  // namespace

Eigen::MatrixXd solve_finite_elements(const FemProblem& problem, FemTriangulation triangulation) {
    check_problem(problem);
    const auto count = static_cast<int>(problem.points.size());
    const int channels = channel_count(problem);
    Eigen::MatrixXd u = Eigen::MatrixXd::Zero(count, channels);
    const std::vector<bool> reached = reached_vertices(problem);

    OffsetSets sets(problem.points.size(), channels);
    for (const FemProblem::Jump& jump : problem.jumps) sets.join(jump.left, jump.right, jump.value);

    // What is known: a vertex's own Dirichlet value, else the value that the jumps give it from the first one of its set.
    std::vector<bool> fixed(problem.points.size()), set_fixed(problem.points.size());
    Eigen::MatrixXd root_value = Eigen::MatrixXd::Zero(count, channels);
    for (const auto& [v, value] : problem.dirichlet) {
        const int r = sets.root(v);
        if (!set_fixed[r])
            root_value.row(r) = value - sets.offset(v);
        set_fixed[r] = true;
        fixed[v] = true;
        u.row(v) = value;
    }
    const Elements elements = assemble(problem, triangulation);
    const auto further = static_cast<int>(elements.carrier.size());
    std::vector<int> unknown(problem.points.size(), -1);  // of the set's root
    int unknowns = 0;
    for (int v = 0; v < count; ++v) {
        if (reached[v] && sets.root(v) == v && !set_fixed[v])
            unknown[v] = unknowns++;
    }
    // u = T x + known
    std::vector<Eigen::Triplet<double>> entries;
    for (int v = 0; v < count; ++v) {
        if (!reached[v] || fixed[v])
            continue;
        const int r = sets.root(v);
        u.row(v) = sets.offset(v);
        if (set_fixed[r]) {
            u.row(v) += root_value.row(r);
        } else {
            entries.emplace_back(v, unknown[r], 1.0);
        }
    }
    for (int i = 0; i < further; ++i) {
        if (reached[elements.carrier[i]])
            entries.emplace_back(count + i, unknowns++, 1.0);
    }
    if (unknowns == 0)
        return u;
    u.conservativeResize(count + further, channels);
    u.bottomRows(further).setZero();
    Matrix T(count + further, unknowns);
    T.setFromTriplets(entries.begin(), entries.end());

    // Delta u = f is S u = -load; f is constant on a face and a hat function's integral over it is a third of its area.
    // The border's points carry none: three corners a given face keep its sum and its centre.
    Eigen::MatrixXd load = Eigen::MatrixXd::Zero(count + further, channels);
    if (problem.laplacian.size() > 0) {
        for (std::size_t f = 0; f < problem.faces.size(); ++f) {
            const double third = face_area(problem, f) / 3;
            for (int v : problem.faces[f]) load.row(v) += third * problem.laplacian.row(static_cast<Eigen::Index>(f));
        }
    }
    const Matrix& S = elements.S;
    const Matrix A = T.transpose() * S * T;
    const Eigen::MatrixXd rhs = -(T.transpose() * (load + S * u));
    const Eigen::SimplicialLDLT<Matrix> factor(A);
    if (factor.info() != Eigen::Success)
        throw std::runtime_error("finite elements: the factorisation failed");
    const Eigen::MatrixXd x = factor.solve(rhs);
    if (factor.info() != Eigen::Success || !x.allFinite())
        throw std::runtime_error("finite elements: the solve failed");
    u += T * x;
    return u.topRows(count);
}

Eigen::RowVectorXd error_scale(const FemProblem& problem, const Eigen::MatrixXd& truth) {
    check_problem(problem);
    if (truth.rows() != static_cast<Eigen::Index>(problem.points.size()))
        throw std::runtime_error("finite elements: a field needs one row a vertex");
    const std::vector<bool> reached = reached_vertices(problem);
    Eigen::RowVectorXd scale(truth.cols());
    for (Eigen::Index channel = 0; channel < truth.cols(); ++channel)
        scale[channel] = scale_of(truth.col(channel), reached).range;
    return scale;
}

std::vector<FieldError> compare_fields(const FemProblem& problem, const Eigen::MatrixXd& truth, const Eigen::MatrixXd& values,
                                       FemTriangulation triangulation) {
    check_problem(problem);
    const auto count = static_cast<Eigen::Index>(problem.points.size());
    if (truth.rows() != count || values.rows() != count || truth.cols() != values.cols()) {
        throw std::runtime_error("finite elements: fields to compare need one row a vertex and equal channels");
    }
    const std::vector<bool> reached = reached_vertices(problem);
    Eigen::VectorXd mask(count), area = Eigen::VectorXd::Zero(count);
    for (Eigen::Index v = 0; v < count; ++v) mask[v] = reached[static_cast<std::size_t>(v)];
    for (std::size_t f = 0; f < problem.faces.size(); ++f) {
        for (int v : problem.faces[f]) area[v] += face_area(problem, f) / 3;
    }
    area = area.cwiseProduct(mask);
    const Matrix S = assemble(problem, triangulation).S;
    const EnergyNorm energy_norm(S, count);
    const auto percent = [](double error, double size) {
        if (error == 0)
            return 0.0;
        return size > 0 ? 100 * error / size : std::numeric_limits<double>::infinity();
    };

    std::vector<FieldError> errors(static_cast<std::size_t>(truth.cols()));
    if (mask.sum() == 0)
        return errors;
    for (Eigen::Index channel = 0; channel < truth.cols(); ++channel) {
        // Selected, not multiplied by the mask: what stands at other vertices must not count, even if it is not a number.
        const Eigen::VectorXd u = (mask.array() > 0).select(truth.col(channel), 0.0);
        const Eigen::VectorXd e = (mask.array() > 0).select(values.col(channel) - truth.col(channel), 0.0);
        const Scale scale = scale_of(u, reached);
        FieldError& error = errors[static_cast<std::size_t>(channel)];
        const double total = area.sum();
        error.mean = percent(total > 0 ? area.dot(e.cwiseAbs()) / total : 0, scale.range);
        error.max = percent(e.cwiseAbs().maxCoeff<Eigen::PropagateNaN>(), scale.range);
        // A constant has no energy; what rounding leaves of it is nothing to measure against (a square root: of 1e-14 of the
        // sum).
        const double size = energy_norm(u), noise = scale.largest * std::sqrt(S.diagonal().cwiseAbs().sum());
        error.h1 = percent(energy_norm(e), size > 1e-7 * noise ? size : noise);
    }
    return errors;
}

}  // namespace pvg
