#include "solve/given_values.h"

#include <vector>

#include "curves/controls.h"

namespace pvg {
namespace {

/// add(term, row of what it gives to) for every term of every number of the domain.
template <typename Add>
GivenValues collect(const Domain& domain, const Knots& knots, Eigen::Index columns, const Add& add) {
    GivenValues given{Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(knots.vertex.size()), columns),
                      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(domain.couplings.size()), columns),
                      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(domain.sources.size()), columns)};
    for (const auto& [vertex, sum] : domain.held)
        if (const int knot = knots.knot_of_vertex[vertex]; knot != none)
            for (const ControlTerm& term : sum) add(term, given.fixed.row(knot));
    for (std::size_t c = 0; c < domain.jumps.size(); ++c)
        for (const ControlTerm& term : domain.jumps[c]) add(term, given.jump.row(static_cast<Eigen::Index>(c)));
    for (std::size_t s = 0; s < domain.source_values.size(); ++s)
        for (const ControlTerm& term : domain.source_values[s]) add(term, given.source.row(static_cast<Eigen::Index>(s)));
    return given;
}

}  // namespace

GivenValues given_values(const Domain& domain, std::span<const int> knot_vertex) {
    const auto n = static_cast<Eigen::Index>(knot_vertex.size());
    GivenValues given{Eigen::MatrixXd::Zero(n, domain.channels),
                      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(domain.couplings.size()), domain.channels),
                      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(domain.sources.size()), domain.channels)};
    for (Eigen::Index j = 0; j < n; ++j)
        if (const int v = knot_vertex[j]; domain.dirichlet[v])
            given.fixed.row(j) = domain.dirichlet_value.row(v);
    for (Eigen::Index c = 0; c < given.jump.rows(); ++c) given.jump.row(c) = domain.couplings[c].jump;
    for (Eigen::Index s = 0; s < given.source.rows(); ++s) given.source.row(s) = domain.sources[s].value;
    return given;
}

GivenValues unit_values(const Domain& domain, const Knots& knots, std::span<const std::pair<int, int>> stops) {
    std::vector<std::vector<std::pair<int, int>>> columns(domain.controls.size());  // per control: (stop, column)
    for (std::size_t k = 0; k < stops.size(); ++k) columns[stops[k].first].emplace_back(stops[k].second, static_cast<int>(k));
    return collect(domain, knots, static_cast<Eigen::Index>(stops.size()), [&](const ControlTerm& term, auto&& row) {
        if (columns[term.control].empty())
            return;
        const auto [stop, weight] = stops_of(term, domain.controls[term.control]);
        for (int i = 0; i < 2; ++i)
            for (const auto& [wanted, column] : columns[term.control])
                if (weight[i] != 0 && static_cast<int>(stop[i]) == wanted)
                    row[column] += weight[i];
    });
}

GivenValues values_of_control(const Domain& domain, const Knots& knots, int control, const Control& values) {
    return collect(domain, knots, domain.channels, [&](const ControlTerm& term, auto&& row) {
        if (term.control != control)
            return;
        const auto [stop, weight] = stops_of(term, values);
        for (int i = 0; i < 2; ++i)
            if (weight[i] != 0)
                row += weight[i] * values.value.row(static_cast<Eigen::Index>(stop[i]));
    });
}

}  // namespace pvg
