// Linear finite elements with cotangent weights. Source: U. Pinkall, K. Polthier, "Computing discrete minimal surfaces and
// their conjugates", 1993; constraints by elimination.
#include "cpu_reference/finite_elements.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include "cpu_reference/delaunay_flips.h"

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

Matrix stiffness(const FemProblem& problem, FemTriangulation triangulation) {
    LengthMesh mesh = make_length_mesh(problem.points, problem.faces);
    if (triangulation == FemTriangulation::intrinsic_delaunay)
        flip_to_delaunay(mesh);
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
    const auto n = static_cast<Eigen::Index>(problem.points.size());
    Matrix S(n, n);
    S.setFromTriplets(entries.begin(), entries.end());
    return S;
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
    if (unknowns == 0)
        return u;
    Matrix T(count, unknowns);
    T.setFromTriplets(entries.begin(), entries.end());

    // Delta u = f is S u = -load; f is constant on a face and a hat function's integral over it is a third of its area.
    Eigen::MatrixXd load = Eigen::MatrixXd::Zero(count, channels);
    if (problem.laplacian.size() > 0) {
        for (std::size_t f = 0; f < problem.faces.size(); ++f) {
            const double third = face_area(problem, f) / 3;
            for (int v : problem.faces[f]) load.row(v) += third * problem.laplacian.row(static_cast<Eigen::Index>(f));
        }
    }
    const Matrix S = stiffness(problem, triangulation);
    const Matrix A = T.transpose() * S * T;
    const Eigen::MatrixXd rhs = -(T.transpose() * (load + S * u));
    const Eigen::SimplicialLDLT<Matrix> factor(A);
    if (factor.info() != Eigen::Success)
        throw std::runtime_error("finite elements: the factorisation failed");
    const Eigen::MatrixXd x = factor.solve(rhs);
    if (factor.info() != Eigen::Success || !x.allFinite())
        throw std::runtime_error("finite elements: the solve failed");
    u += T * x;
    return u;
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
    const Matrix S = stiffness(problem, triangulation);
    const auto percent = [](double error, double size) {
        if (error == 0)
            return 0.0;
        return size > 0 ? 100 * error / size : std::numeric_limits<double>::infinity();
    };

    const auto energy_norm = [&](const Eigen::VectorXd& v) {
        const double energy = v.dot(S * v);
        return energy < 0 ? 0 : std::sqrt(energy);  // rounding may make 0 negative; what is not a number stays so
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
        // A constant has no energy; what rounding leaves of it is nothing to measure against (a square root: of 1e-14 of the sum).
        const double size = energy_norm(u), noise = scale.largest * std::sqrt(S.diagonal().cwiseAbs().sum());
        error.h1 = percent(energy_norm(e), size > 1e-7 * noise ? size : noise);
    }
    return errors;
}

}  // namespace pvg
