#include "solve/galerkin.h"

#include <algorithm>

#include "solve/bounds.h"
#include "solve/given_values.h"

namespace pvg {
namespace {

/// One row a vertex or coefficient, one column a channel.
using Values = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Psi and its transpose, as they stand in the table; all channels at once.
class TableProduct {
public:
    TableProduct(const Table& table, Eigen::Index channels) : table_(table), channels_(channels) {}

    /// By vertex: V x C.
    Values values(const Values& coefficients) const {
        Values u = Values::Zero(table_.row_count, channels_);
        for_each_weight([&](std::uint32_t vertex, std::uint32_t coefficient, double weight) {
            for (Eigen::Index c = 0; c < channels_; ++c) u(vertex, c) += weight * coefficients(coefficient, c);
        });
        return u;
    }
    /// What each coefficient feels of forces on the vertices.
    Values gather(const Values& forces) const {
        Values sum = Values::Zero(table_.coefficient_count, channels_);
        for_each_weight([&](std::uint32_t vertex, std::uint32_t coefficient, double weight) {
            for (Eigen::Index c = 0; c < channels_; ++c) sum(coefficient, c) += weight * forces(vertex, c);
        });
        return sum;
    }

private:
    template <typename Work>
    void for_each_weight(const Work& work) const {
        for (std::uint32_t cell = 0; cell < table_.cell_count; ++cell) {
            const std::uint32_t list = table_.cell_first_index[cell], length = table_.cell_first_index[cell + 1] - list;
            std::size_t block = table_.cell_first_weight[cell];
            for (std::uint32_t row = table_.cell_first_row[cell]; row < table_.cell_first_row[cell + 1]; ++row, block += length)
                for (std::uint32_t k = 0; k < length; ++k)
                    if (const float weight = table_.weights[block + k]; weight != 0)
                        work(table_.row_vertex[row], table_.indices[list + k], double{weight});
        }
    }

    const Table& table_;
    Eigen::Index channels_;
};

/// -(S u + load), by vertex, from S u.
Values unbalanced_forces(const EnergyForm& form, const Eigen::MatrixXd& source, const Values& internal) {
    Values forces = -internal;
    for (Eigen::Index v = 0; v < forces.rows(); ++v)
        for (int i = form.load_first[v]; i < form.load_first[v + 1]; ++i)
            forces.row(v) -= form.loads[i].second * source.row(form.loads[i].first);
    return forces;
}

Eigen::RowVectorXd dot(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) { return (a.array() * b.array()).colwise().sum(); }

}  // namespace

int minimise_energy(const EnergyForm& form, const Table& table, const System& system, const Eigen::MatrixXd& source,
                    const GalerkinOptions& options, Eigen::MatrixXd& lambda) {
    const Eigen::Index knots = lambda.rows(), channels = lambda.cols();
    if (system.unknowns() == 0)
        return 0;
    const TableProduct psi(table, channels);
    Values coefficients = Values::Zero(table.coefficient_count, channels);
    coefficients.topRows(knots) = lambda;
    coefficients.bottomRows(source.rows()) = source;

    const Values u = psi.values(coefficients), internal = form.S * u;
    Eigen::MatrixXd residual = psi.gather(unbalanced_forces(form, source, internal)).topRows(knots);
    Eigen::MatrixXd direction = system.apply_inverse(residual);
    Eigen::RowVectorXd size = dot(residual, direction);
    // Where the cell system has the optimum already, what is left is rounding: it has no direction to go in, and conjugate
    // gradients that take it for one diverge.
    const Eigen::RowVectorXd rounding = 1e-24 * (u.array() * internal.array()).colwise().sum();
    const Eigen::RowVectorXd enough = (size * (options.reduction * options.reduction)).cwiseMax(rounding);
    coefficients.setZero();
    // Largest change of the last steps before options.steps, of the range.
    Eigen::RowVectorXd late_change = Eigen::RowVectorXd::Zero(channels);
    int steps = 0;
    const auto rests = [&](Eigen::Index c) {
        return !(size[c] > enough[c]) || (steps >= options.steps && late_change[c] <= options.settled);
    };
    const auto all_rest = [&] {
        for (Eigen::Index c = 0; c < channels; ++c)
            if (!rests(c))
                return false;
        return true;
    };
    for (; steps < options.max_steps && !all_rest(); ++steps) {
        coefficients.topRows(knots) = direction;
        const Eigen::MatrixXd change = psi.gather(form.S * psi.values(coefficients)).topRows(knots);
        const Eigen::RowVectorXd curvature = dot(direction, change);
        for (Eigen::Index c = 0; c < channels; ++c) {
            if (rests(c) || !(curvature[c] > 0))
                continue;
            const double length = size[c] / curvature[c];
            lambda.col(c) += length * direction.col(c);
            residual.col(c) -= length * change.col(c);
            const double range = lambda.col(c).maxCoeff() - lambda.col(c).minCoeff();
            if (steps + 3 >= options.steps && steps < options.steps && range > 0)
                late_change[c] = std::max(late_change[c], length * direction.col(c).cwiseAbs().maxCoeff() / range);
        }
        const Eigen::MatrixXd preconditioned = system.apply_inverse(residual);
        const Eigen::RowVectorXd next = dot(residual, preconditioned);
        for (Eigen::Index c = 0; c < channels; ++c)
            direction.col(c) = preconditioned.col(c) + (size[c] > 0 ? next[c] / size[c] : 0) * direction.col(c);
        size = next;
    }
    return steps;
}

int minimise_energy(const PatchSpace& space, const Table& table, const System& system, const GalerkinOptions& options,
                    Eigen::MatrixXd& lambda) {
    const int steps =
        minimise_energy(space, table, system, given_values(space.domain, space.knots.vertex).source, options, lambda);
    if (options.bounded && system.unknowns() > 0)
        keep_between_bounds(space.domain, space.knots, lambda);
    return steps;
}

}  // namespace pvg
