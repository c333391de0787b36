// One problem solved in every way that the project has, each way's distance from a reference, and the order that errors
// fall with.
#pragma once

#include <chrono>
#include <cmath>
#include <span>

#include "fixtures/fem.h"
#include "convergence/problems.h"
#include "cpu_reference/finite_elements.h"
#include "solve/basis.h"
#include "solve/galerkin.h"
#include "solve/system.h"

namespace pvg::fixtures {

/// % of the reference's range; l2 is the area-weighted root mean square, h1 relative to the reference's energy norm.
struct Norms {
    double l2 = 0, mean = 0, max = 0, h1 = 0;
};

/// The slope of log error over log h, by least squares.
inline double fitted_order(std::span<const double> h, std::span<const double> error) {
    const auto n = static_cast<double>(h.size());
    double x = 0, y = 0, xx = 0, xy = 0;
    for (std::size_t i = 0; i < h.size(); ++i) {
        const double a = std::log(h[i]), b = std::log(error[i]);
        x += a / n;
        y += b / n;
        xx += a * a / n;
        xy += a * b / n;
    }
    return (xy - x * y) / (xx - x * x);
}

inline double mean_edge(const Domain& domain) {
    double sum = 0;
    for (int h = 0; h < domain.surface.halfedge_count(); ++h) sum += domain.surface.length(h);
    return sum / domain.surface.halfedge_count();
}

using fixtures::fem_problem;

inline Norms field_norms(const FemProblem& problem, const Eigen::VectorXd& reference, const Eigen::VectorXd& values) {
    const FieldError error = compare_fields(problem, reference, values)[0];
    double square = 0, area = 0;
    for (const auto& [a, b, c] : problem.faces) {
        const double third = (problem.points[b] - problem.points[a]).cross(problem.points[c] - problem.points[a]).norm() / 6;
        for (int v : {a, b, c}) square += third * std::pow(values[v] - reference[v], 2);
        area += 3 * third;
    }
    const double range = reference.maxCoeff() - reference.minCoeff();
    return {100 * std::sqrt(square / area) / range, error.mean, error.max, error.h1};
}

class Stopwatch {
public:
    double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count(); }

private:
    std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

/// A domain with its local basis and both kinds of control coefficients.
class LocalSolution {
public:
    /// spacing in mesh units; grading 1: the default ones. The domain must outlive it.
    LocalSolution(const Domain& domain_, double spacing, double grading = 1)
        : domain(domain_),
          knots(place_knots(domain, {.spacing = spacing,
                                     .grading = grading * KnotOptions().grading,
                                     .feature_grading = grading * KnotOptions().feature_grading,
                                     .most_edges = 1e9})),  // the spacing is what is studied
          voronoi(geodesic_voronoi(domain, knots)),
          system(domain, knots, voronoi),
          cell_lambda(system.solve(domain)),
          cell_seconds(watch_.seconds()),
          space(domain, knots, voronoi),
          table(local_basis(space, {.threads = 2})),
          basis_seconds(watch_.seconds()) {
        Eigen::MatrixXd lambda = cell_lambda;
        minimise_energy(space, table, system, {}, lambda);
        energy_lambda = lambda;
        energy_seconds = watch_.seconds();
    }
    LocalSolution(const LocalSolution&) = delete;  // the space refers to its siblings

    Eigen::VectorXd field(const Eigen::VectorXd& lambda) const {
        Eigen::VectorXd coefficients(table.coefficient_count);
        coefficients.head(lambda.size()) = lambda;
        for (std::size_t s = 0; s < domain.sources.size(); ++s)
            coefficients[lambda.size() + static_cast<Eigen::Index>(s)] = domain.sources[s].value[0];
        return evaluate(table, coefficients);
    }
    /// At the knots alone, weighted by their cells; h1 in the energy of the cell system.
    Norms knot_norms(const Eigen::VectorXd& reference, const Eigen::VectorXd& lambda) const {
        Norms norms;
        double area = 0, energy = 0, whole = 0;
        Eigen::VectorXd error(lambda.size());
        for (Eigen::Index j = 0; j < lambda.size(); ++j) {
            error[j] = lambda[j] - reference[knots.vertex[j]];
            norms.l2 += voronoi.area[j] * error[j] * error[j];
            norms.mean += voronoi.area[j] * std::abs(error[j]);
            norms.max = std::max(norms.max, std::abs(error[j]));
            area += voronoi.area[j];
        }
        for (const CellEdge& edge : voronoi.edges) {
            energy += edge.weight * std::pow(error[edge.a] - error[edge.b], 2);
            whole += edge.weight * std::pow(reference[knots.vertex[edge.a]] - reference[knots.vertex[edge.b]], 2);
        }
        const double scale = 100 / (reference.maxCoeff() - reference.minCoeff());
        return {scale * std::sqrt(norms.l2 / area), scale * norms.mean / area, scale * norms.max,
                100 * std::sqrt(energy / whole)};
    }

private:
    Stopwatch watch_;

public:
    const Domain& domain;
    Knots knots;
    Voronoi voronoi;
    System system;
    Eigen::VectorXd cell_lambda;
    double cell_seconds;  ///< until the cell system's lambda
    PatchSpace space;
    Table table;
    double basis_seconds;  ///< until the table
    Eigen::VectorXd energy_lambda;
    double energy_seconds = 0;  ///< until the energy-optimal lambda
};

}  // namespace pvg::fixtures
