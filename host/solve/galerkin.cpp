#include "solve/galerkin.h"

#include <algorithm>

#include "solve/bounds.h"
#include "solve/given_values.h"

namespace pvg {
namespace {

Eigen::RowVectorXd dot(const KnotValues& a, const KnotValues& b) { return (a.array() * b.array()).colwise().sum(); }

}  // namespace

int minimise_energy(const GalerkinMatrix& matrix, const System& system, const Eigen::MatrixXd& source,
                    const GalerkinOptions& options, Eigen::MatrixXd& all_lambda) {
    if (system.unknowns() == 0)
        return 0;
    const Eigen::Index channels = all_lambda.cols();
    KnotValues lambda = all_lambda, internal, load;
    multiply(matrix.A, lambda, internal, options.threads);
    multiply(matrix.B, source, load, options.threads);
    KnotValues residual = -(internal + load), change;
    KnotValues direction = system.apply_inverse(residual);
    Eigen::RowVectorXd size = dot(residual, direction);
    // Where the cell system has the optimum already, what is left is rounding: it has no direction to go in, and conjugate
    // gradients that take it for one diverge.
    const Eigen::RowVectorXd rounding = 1e-24 * (dot(lambda, internal).cwiseAbs() + dot(lambda, load).cwiseAbs());
    const Eigen::RowVectorXd enough = (size * (options.reduction * options.reduction)).cwiseMax(rounding);
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
        multiply(matrix.A, direction, change, options.threads);
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
        const KnotValues preconditioned = system.apply_inverse(residual);
        const Eigen::RowVectorXd next = dot(residual, preconditioned);
        for (Eigen::Index c = 0; c < channels; ++c)
            direction.col(c) = preconditioned.col(c) + (size[c] > 0 ? next[c] / size[c] : 0) * direction.col(c);
        size = next;
    }
    all_lambda = lambda;
    return steps;
}

int minimise_energy(const PatchSpace& space, const Table& table, const System& system, const GalerkinOptions& options,
                    Eigen::MatrixXd& lambda) {
    const GalerkinMatrix matrix = galerkin_matrix(space, table, static_cast<int>(lambda.rows()), options.threads);
    const int steps = minimise_energy(matrix, system, given_values(space.domain, space.knots.vertex).source, options, lambda);
    if (options.bounded && system.unknowns() > 0)
        keep_between_bounds(space.domain, space.knots, lambda);
    return steps;
}

}  // namespace pvg
