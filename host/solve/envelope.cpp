#include "solve/envelope.h"

#include <algorithm>
#include <cmath>

namespace pvg {

void EnvelopeCholesky::begin(const std::vector<int>& first_column) {
    first_ = first_column;
    start_.resize(first_.size() + 1);
    start_[0] = 0;
    for (std::size_t i = 0; i < first_.size(); ++i) start_[i + 1] = start_[i] + (i - first_[i] + 1);
    values_.assign(start_.back(), 0.0);
}

int EnvelopeCholesky::factor() {
    constexpr double vanishing = 1e-11;
    const int n = static_cast<int>(first_.size());
    int fixed = 0;
    for (int i = 0; i < n; ++i) {
        double* const row = values_.data() + start_[i];
        const int begin = first_[i];
        for (int j = begin; j < i; ++j) {
            const double* const other = values_.data() + start_[j];
            const int from = std::max(begin, first_[j]);
            const int count = j - from;
            double sum = row[j - begin];
            if (count > 0)
                sum -= Eigen::Map<const Eigen::VectorXd>(row + (from - begin), count)
                           .dot(Eigen::Map<const Eigen::VectorXd>(other + (from - first_[j]), count));
            row[j - begin] = sum * other[j - first_[j]];
        }
        const double diagonal = row[i - begin];
        const double pivot = diagonal - (i > begin ? Eigen::Map<const Eigen::VectorXd>(row, i - begin).squaredNorm() : 0.0);
        // The diagonal holds the inverse of the factor's; 0 fixes the unknown.
        if (pivot > vanishing * diagonal && std::isfinite(pivot)) {
            row[i - begin] = 1 / std::sqrt(pivot);
        } else {
            row[i - begin] = 0;
            for (int j = begin; j < i; ++j) row[j - begin] = 0;
            ++fixed;
        }
    }
    return fixed;
}

void EnvelopeCholesky::solve(RowMatrix& X) const {
    using Four = Eigen::Array4d;
    const int n = static_cast<int>(first_.size());
    const Eigen::Index width = X.cols();
    double* const x = X.data();
    for (int i = 0; i < n; ++i) {
        const double* const row = values_.data() + start_[i];
        const int begin = first_[i], count = i - begin;
        double* const own = x + i * width;
        for (Eigen::Index k = 0; k < width; k += 4) {
            Four sum = Eigen::Map<const Four>(own + k);
            const double* other = x + begin * width + k;
            for (int j = 0; j < count; ++j, other += width) sum -= row[j] * Eigen::Map<const Four>(other);
            Eigen::Map<Four>(own + k) = sum * row[count];
        }
    }
    for (int i = n - 1; i >= 0; --i) {
        const double* const row = values_.data() + start_[i];
        const int begin = first_[i], count = i - begin;
        double* const own = x + i * width;
        for (Eigen::Index k = 0; k < width; k += 4) {
            const Four value = Eigen::Map<const Four>(own + k) * row[count];
            Eigen::Map<Four>(own + k) = value;
            double* other = x + begin * width + k;
            for (int j = 0; j < count; ++j, other += width) Eigen::Map<Four>(other) -= row[j] * value;
        }
    }
}

}  // namespace pvg
