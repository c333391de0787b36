#include "solve/border_fit.h"

#include <cmath>

#include <Eigen/Cholesky>

namespace pvg {

RowMatrix fitted_rows(const Patch& patch, const FitOptions& options) {
    const int listed = static_cast<int>(patch.list.size()), count = static_cast<int>(patch.rows.size()) - patch.list_knots;
    const int data = static_cast<int>(patch.data.size()), modes = static_cast<int>(patch.modes.cols());
    RowMatrix result = patch.known.bottomRows(count);
    if (data == 0 && patch.fixed.empty())
        return result;

    // Data: lambda minus what is known already.
    RowMatrix M(data, modes), known(data, listed);
    Eigen::VectorXd weight(data);
    for (int d = 0; d < data; ++d) {
        const int entry = patch.data[d];
        M.row(d) = patch.modes.row(entry);
        known.row(d) = -patch.known.row(entry);
        known(d, entry) += 1;
        const double r = patch.radius > 0 ? options.falloff * patch.distance[entry] / patch.radius : 0;
        weight[d] = 1 / ((1 + r * r) * (1 + r * r));
    }

    // The constant first, so that no penalty and no rank guard touches it and rows keep their sum.
    Eigen::RowVectorXd mean_mode = Eigen::RowVectorXd::Zero(modes), mean_known = Eigen::RowVectorXd::Zero(listed);
    if (patch.free_constant && data > 0) {
        const double total = weight.sum();
        mean_mode = weight.transpose() * M / total;
        mean_known = weight.transpose() * known / total;
        M.rowwise() -= mean_mode;
        known.rowwise() -= mean_known;
    }
    Eigen::MatrixXd normal = M.transpose() * weight.asDiagonal() * M;
    const double size = std::max(weight.sum(), options.curves);
    const double guard = 1e-10 * std::max(normal.trace(), options.curves);
    for (int m = 0; m < modes; ++m) {
        const int degree = (m + 1) / 2;
        normal(m, m) += guard;
        if (degree >= 2)
            normal(m, m) += size * options.penalty * std::pow(options.growth, degree - 2);
    }
    Eigen::MatrixXd right = M.transpose() * weight.asDiagonal() * known;
    // In a channel between curves few knots are free, or none: the slope along it is then that of the curves' own values.
    if (const int fixed = static_cast<int>(patch.fixed.size()); fixed > 0) {
        RowMatrix P = patch.polynomials, values = RowMatrix::Zero(fixed, listed);
        for (int f = 0; f < fixed; ++f) values(f, patch.fixed[f]) = 1;
        const Eigen::RowVectorXd mean_P = P.colwise().mean(), mean_value = values.colwise().mean();
        P.rowwise() -= mean_P;
        values.rowwise() -= mean_value;
        normal.noalias() += options.curves * P.transpose() * P;
        right.noalias() += options.curves * P.transpose() * values;
    }
    const Eigen::MatrixXd coefficient = normal.llt().solve(right);  // modes x listed
    result.noalias() += (patch.modes.bottomRows(count).rowwise() - mean_mode) * coefficient;
    if (patch.free_constant)
        result.rowwise() += mean_known;
    return result;
}

}  // namespace pvg
