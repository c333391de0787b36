// How a domain's coefficients answer to its controls. lambda is linear in what the scene gives, so each stop of a control has one
// column of responses, the energy-optimal coefficients of its value 1 alone. A column costs a solve once; from then on a new
// value of its stop costs one multiplication and addition a knot.
#pragma once

#include <map>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "curves/domain.h"
#include "pvg/table.h"
#include "solve/galerkin_matrix.h"
#include "solve/knots.h"
#include "solve/system.h"

namespace pvg {

/// One domain with the local basis. Refers to all that it is made from; not thread-safe. N knots, K controls, C channels.
class Responses {
public:
    using Stop = std::pair<int, int>;  ///< (control, stop)

    /// unbounded: lambda as solved for the values that the domain's controls have (SolvedDomain::unbounded).
    Responses(const Domain& domain, const Knots& knots, const System& system, const GalerkinMatrix& matrix, const Table& table,
              const Eigen::MatrixXd& unbounded);

    /// Solves for the columns of these stops that are missing, all together. Stops that enter with the same weights (colour and
    /// height of the same stop) share a column. Returns the columns solved.
    int prepare(std::span<const Stop> stops);
    /// Every stop of every control.
    int prepare_all();

    /// The coefficients (Field::coefficients) for controls with these stops and values, K as the domain has, each with at least
    /// one stop. Depends on them alone, not on those asked for before. Stops whose values are new are prepared; a control whose
    /// stops stand elsewhere than in the domain costs a solve each time.
    const std::vector<float>& coefficients(std::span<const Control> controls);

private:
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    struct PartControls {
        std::vector<int> bounding;  // whose values bound the part
        std::vector<int> opening;   // sources and jumps: a channel in which one of them is not 0 has no bounds
    };

    void find_same_stops();
    void find_parts();
    struct Bounds {
        RowMajor low, high;  // parts x C; infinite where a channel is not bounded
        bool any = false;
    };
    Bounds bounds(std::span<const Control> controls) const;
    template <int channels>
    void combine(std::span<const std::pair<const float*, Eigen::RowVectorXf>> change, const Bounds& within);
    Eigen::MatrixXd solve(const GivenValues& given) const;

    const Domain& domain_;
    const Knots& knots_;
    const System& system_;
    const GalerkinMatrix& matrix_;
    const Table& table_;
    Eigen::MatrixXd first_lambda_;             // N x C
    std::map<Stop, Stop> same_as_;             // the first stop that enters with the same weights
    std::map<Stop, Eigen::VectorXf> columns_;  // N each, filled up with 0 to whole blocks, by first stop of its kind
    std::vector<int> part_of_knot_;            // N
    std::vector<PartControls> parts_;
    Eigen::MatrixXd moved_lambda_;  // N x C: first_lambda_ and what moved stops add
    std::vector<float> coefficients_;
};

}  // namespace pvg
