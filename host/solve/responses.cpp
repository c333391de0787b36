#include "solve/responses.h"

#include <algorithm>
#include <array>
#include <limits>
#include <tuple>

#include "curves/controls.h"
#include "solve/bounds.h"
#include "solve/galerkin.h"
#include "solve/given_values.h"

namespace pvg {
namespace {

/// Far below what the coefficients of a fresh build leave (GalerkinOptions), so that a changed value adds no error to speak of.
constexpr GalerkinOptions response_options{.max_steps = 60, .reduction = 1e-7, .settled = 0, .bounded = false};
/// Columns solved together: the operators are read once for all of them.
constexpr std::size_t batch = 8;
/// Knots whose coefficients are summed up together: few enough to stay in the innermost cache.
constexpr Eigen::Index block = 64;
using Block = Eigen::Array<float, block, 1>;

Eigen::Index whole_blocks(Eigen::Index knots) { return (knots + block - 1) / block * block; }

void add_unique(std::vector<int>& list, int value) {
    if (std::find(list.begin(), list.end(), value) == list.end())
        list.push_back(value);
}

void subtract(GivenValues& from, const GivenValues& other) {
    from.fixed -= other.fixed;
    from.jump -= other.jump;
    from.source -= other.source;
}

}  // namespace

Responses::Responses(const Domain& domain, const Knots& knots, const System& system, const GalerkinMatrix& matrix,
                     const Table& table, const Eigen::MatrixXd& unbounded)
    : domain_(domain), knots_(knots), system_(system), matrix_(matrix), table_(table), first_lambda_(unbounded) {
    first_lambda_.conservativeResize(whole_blocks(unbounded.rows()), Eigen::NoChange);
    first_lambda_.bottomRows(first_lambda_.rows() - unbounded.rows()).setZero();
    find_same_stops();
    find_parts();
}

void Responses::find_same_stops() {
    using Entry = std::tuple<int, int, double>;  // kind of number, its index, weight
    std::map<Stop, std::vector<Entry>> entries;
    for (std::size_t k = 0; k < domain_.controls.size(); ++k)
        for (std::size_t s = 0; s < domain_.controls[k].t.size(); ++s) entries[{static_cast<int>(k), static_cast<int>(s)}];
    const auto add = [&](const ControlSum& sum, int kind, std::size_t index) {
        for (const ControlTerm& term : sum) {
            const auto [stop, weight] = stops_of(term, domain_.controls[term.control]);
            for (int i = 0; i < 2; ++i)
                if (weight[i] != 0)
                    entries[{term.control, static_cast<int>(stop[i])}].emplace_back(kind, static_cast<int>(index), weight[i]);
        }
    };
    for (const auto& [vertex, sum] : domain_.held) add(sum, 0, static_cast<std::size_t>(vertex));
    for (std::size_t c = 0; c < domain_.jumps.size(); ++c) add(domain_.jumps[c], 1, c);
    for (std::size_t s = 0; s < domain_.source_values.size(); ++s) add(domain_.source_values[s], 2, s);
    std::map<std::vector<Entry>, Stop> first;
    for (auto& [stop, list] : entries) same_as_[stop] = first.emplace(std::move(list), stop).first->second;
}

void Responses::find_parts() {
    int count = 0;
    const std::vector<int> part = number_parts(domain_, count);
    parts_.resize(count);
    for (int vertex : knots_.vertex) part_of_knot_.push_back(part[vertex]);
    for (const auto& [vertex, sum] : domain_.held)
        if (part[vertex] != none)
            for (const ControlTerm& term : sum) {
                const bool side = domain_.controls[term.control].part <= ControlPart::right;
                add_unique(side ? parts_[part[vertex]].bounding : parts_[part[vertex]].opening, term.control);
            }
    for (std::size_t c = 0; c < domain_.jumps.size(); ++c)
        if (const int p = part[domain_.couplings[c].left]; p != none)
            for (const ControlTerm& term : domain_.jumps[c]) add_unique(parts_[p].opening, term.control);
    for (std::size_t s = 0; s < domain_.source_values.size(); ++s) {
        std::vector<int> touched;
        for (const auto& [face, laplacian] : domain_.sources[s].profile)
            if (laplacian != 0)
                add_unique(touched, part[domain_.surface.face(face)[0]]);
        for (int p : touched)
            for (const ControlTerm& term : domain_.source_values[s]) add_unique(parts_[p].opening, term.control);
    }
}

Eigen::MatrixXd Responses::solve(const GivenValues& given) const {
    Eigen::MatrixXd lambda = system_.solve(domain_, given);
    minimise_energy(matrix_, system_, given.source, response_options, lambda);
    return lambda;
}

int Responses::prepare(std::span<const Stop> stops) {
    std::vector<Stop> missing;
    for (const Stop& stop : stops)
        if (const Stop& same = same_as_.at(stop); !columns_.contains(same))
            missing.push_back(same);
    std::sort(missing.begin(), missing.end());
    missing.erase(std::unique(missing.begin(), missing.end()), missing.end());
    for (std::size_t begin = 0; begin < missing.size(); begin += batch) {
        const std::span<const Stop> some(missing.data() + begin, std::min(batch, missing.size() - begin));
        const Eigen::MatrixXd lambda = solve(unit_values(domain_, knots_, some));
        for (std::size_t k = 0; k < some.size(); ++k) {
            Eigen::VectorXf& column = columns_[some[k]];
            column = Eigen::VectorXf::Zero(first_lambda_.rows());
            column.head(lambda.rows()) = lambda.col(static_cast<Eigen::Index>(k)).cast<float>();
        }
    }
    return static_cast<int>(missing.size());
}

int Responses::prepare_all() {
    std::vector<Stop> stops;
    for (const auto& [stop, same] : same_as_) stops.push_back(stop);
    return prepare(stops);
}

const std::vector<float>& Responses::coefficients(std::span<const Control> controls) {
    std::vector<Stop> changed;
    const auto knots = static_cast<Eigen::Index>(knots_.vertex.size());
    moved_lambda_.resize(0, 0);
    for (std::size_t k = 0; k < controls.size(); ++k) {
        const Control& first = domain_.controls[k];
        const int control = static_cast<int>(k);
        if (controls[k].t == first.t) {
            for (int s = 0; s < first.value.rows(); ++s)
                if (controls[k].value.row(s) != first.value.row(s))
                    changed.emplace_back(control, s);
        } else {
            GivenValues given = values_of_control(domain_, knots_, control, controls[k]);
            subtract(given, values_of_control(domain_, knots_, control, first));
            if (moved_lambda_.size() == 0)
                moved_lambda_ = first_lambda_;
            moved_lambda_.topRows(knots) += solve(given);
        }
    }
    prepare(changed);
    std::map<Stop, Eigen::RowVectorXd> by_column;
    for (const Stop& stop : changed)
        by_column.try_emplace(same_as_.at(stop), Eigen::RowVectorXd::Zero(domain_.channels)).first->second +=
            controls[stop.first].value.row(stop.second) - domain_.controls[stop.first].value.row(stop.second);
    std::vector<std::pair<const float*, Eigen::RowVectorXf>> change;
    for (const auto& [stop, difference] : by_column) change.emplace_back(columns_.at(stop).data(), difference.cast<float>());

    coefficients_.resize(static_cast<std::size_t>(table_.coefficient_count) * table_.channels);
    switch (domain_.channels) {
        case 1:
            combine<1>(change, bounds(controls));
            break;
        case 4:
            combine<4>(change, bounds(controls));
            break;
        default:
            combine<5>(change, bounds(controls));
            break;
    }
    float* out = coefficients_.data() + knots * domain_.channels;
    for (const ControlSum& sum : domain_.source_values) {
        const Eigen::RowVectorXd value = value_of(sum, controls, domain_.channels);
        for (Eigen::Index c = 0; c < value.size(); ++c) *out++ = static_cast<float>(value[c]);
    }
    return coefficients_;
}

/// What changed is summed in single precision, since that is what the coefficients end in. One pass over the knots, all columns
/// and channels of a block while it is in the innermost cache.
template <int channels>
void Responses::combine(std::span<const std::pair<const float*, Eigen::RowVectorXf>> change, const Bounds& within) {
    const Eigen::MatrixXd& from = moved_lambda_.size() > 0 ? moved_lambda_ : first_lambda_;
    const auto knots = static_cast<Eigen::Index>(knots_.vertex.size());
    std::array<Block, channels> sum;
    for (Eigen::Index begin = 0; begin < knots; begin += block) {
        for (Block& part : sum) part.setZero();
        for (const auto& [column, difference] : change) {
            const Block response = Eigen::Map<const Block>(column + begin);
            for (int c = 0; c < channels; ++c) sum[c] += response * difference[c];
        }
        const Eigen::Index end = std::min(knots, begin + block);
        for (Eigen::Index j = begin; j < end; ++j) {
            float* out = coefficients_.data() + j * channels;
            const int p = within.any ? part_of_knot_[j] : none;
            for (int c = 0; c < channels; ++c) {
                double value = from(j, c) + double{sum[c][j - begin]};
                if (p != none)
                    value = std::min(std::max(value, within.low(p, c)), within.high(p, c));
                out[c] = static_cast<float>(value);
            }
        }
    }
}

Responses::Bounds Responses::bounds(std::span<const Control> controls) const {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const int channels = domain_.channels;
    Bounds result{RowMajor::Constant(static_cast<Eigen::Index>(parts_.size()), channels, infinity), {}, false};
    auto& [low, high, any] = result;
    high = -low;
    for (Eigen::Index p = 0; p < low.rows(); ++p) {
        const PartControls& part = parts_[p];
        for (int c = 0; c < channels; ++c) {
            for (int k : part.bounding) {
                // A height's control says nothing of colours, and the other way round.
                const bool own = controls[k].quantity == Quantity::color ? c < 4 : c + 1 == channels;
                if (own) {
                    low(p, c) = std::min(low(p, c), controls[k].value.col(c).minCoeff());
                    high(p, c) = std::max(high(p, c), controls[k].value.col(c).maxCoeff());
                }
            }
            const bool open = low(p, c) > high(p, c) || std::any_of(part.opening.begin(), part.opening.end(),
                                                                    [&](int k) { return !controls[k].value.col(c).isZero(0); });
            if (open) {
                low(p, c) = -infinity;
                high(p, c) = infinity;
            }
            any |= !open;
        }
    }
    return result;
}

}  // namespace pvg
