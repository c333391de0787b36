// How far every basis is from finite elements on the same vertices, and how far the knots' coefficients are: what check reports.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "cpu_reference/finite_elements.h"
#include "solve/build.h"

namespace pvg::app {

/// Mean and largest |lambda - truth| over the knots, in % of the channel's error_scale; the mean weighted by the cells' areas.
struct KnotError {
    double mean = 0;
    double max = 0;
};

/// One domain. Each list has one entry a channel.
struct DomainErrors {
    struct Basis {
        std::string name;  ///< "local", "green", "green_raw" or "exact"
        std::vector<FieldError> channels;
    };
    std::vector<Basis> bases;            ///< in that order; those left out are missing
    std::vector<KnotError> cell_lambda;  ///< of the cell system
    std::vector<KnotError> lambda;       ///< that the scene's own basis is evaluated with
};

struct BasesOptions {
    BasisChoice own;         ///< the scene's
    bool with_green = true;  ///< "green" and "green_raw", which cost one solve of the whole domain a knot
    int threads = 0;
    std::function<void(const std::string&)> on_stage = {};  ///< the name of what begins
    std::function<void(double)> on_progress = {};           ///< as in FieldOptions
};

/// The name of a basis among the four.
std::string basis_name(const BasisChoice& choice);

/// own_values: rows x channels of the scene's own field, as its evaluator gave them; the other bases are built and evaluated
/// here.
DomainErrors compare_bases(const Domain& domain, const SolvedDomain& solved, const Table& own_table,
                           const std::vector<float>& own_values, const BasesOptions& options);

}  // namespace pvg::app
