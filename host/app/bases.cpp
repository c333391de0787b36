#include "app/bases.h"

#include <cmath>

#include "cpu_reference/cpu_evaluator.h"
#include "solve/field.h"

namespace pvg::app {
namespace {

FemProblem fem_problem(const Domain& domain) {
    FemProblem problem;
    problem.points = domain.surface.points();
    problem.faces = domain.surface.faces();
    for (int v = 0; v < domain.surface.vertex_count(); ++v)
        if (domain.dirichlet[v])
            problem.dirichlet.emplace_back(v, domain.dirichlet_value.row(v));
    for (const Coupling& coupling : domain.couplings) problem.jumps.push_back({coupling.left, coupling.right, coupling.jump});
    problem.laplacian = Eigen::MatrixXd::Zero(domain.surface.face_count(), domain.channels);
    for (const SourceColumn& source : domain.sources)
        for (const auto& [face, profile] : source.profile) problem.laplacian.row(face) += profile * source.value;
    return problem;
}

/// A field's evaluated values in the order of its domain's vertices.
Eigen::MatrixXd by_vertex(const Table& table, const std::vector<float>& rows) {
    Eigen::MatrixXd values(table.row_count, table.channels);
    for (std::uint32_t v = 0; v < table.row_count; ++v)
        for (std::uint32_t c = 0; c < table.channels; ++c)
            values(v, c) = rows[static_cast<std::size_t>(table.vertex_row[v]) * table.channels + c];
    return values;
}

std::vector<KnotError> knot_errors(const SolvedDomain& solved, const Eigen::MatrixXd& lambda, const Eigen::MatrixXd& truth,
                                   const Eigen::RowVectorXd& scale) {
    std::vector<KnotError> errors(static_cast<std::size_t>(lambda.cols()));
    for (Eigen::Index c = 0; c < lambda.cols(); ++c) {
        double sum = 0, area = 0, worst = 0;
        for (std::size_t j = 0; j < solved.knots.vertex.size(); ++j) {
            const double error = std::abs(lambda(static_cast<Eigen::Index>(j), c) - truth(solved.knots.vertex[j], c));
            sum += solved.voronoi.area[j] * error;
            area += solved.voronoi.area[j];
            worst = std::max(worst, error);
        }
        const double percent = scale[c] > 0 ? 100 / scale[c] : 0;
        errors[static_cast<std::size_t>(c)] = {area > 0 ? sum / area * percent : 0, worst * percent};
    }
    return errors;
}

}  // namespace

std::string basis_name(const BasisChoice& choice) {
    switch (choice.kind) {
        case BasisKind::green:
            return choice.normalize ? "green" : "green_raw";
        case BasisKind::exact:
            return "exact";
        case BasisKind::local:
            break;
    }
    return "local";
}

DomainErrors compare_bases(const Domain& domain, const SolvedDomain& solved, const Table& own_table,
                           const std::vector<float>& own_values, const BasesOptions& options) {
    const auto enter = [&](const std::string& stage) {
        if (options.on_stage)
            options.on_stage(stage);
    };
    enter("finite elements");
    const FemProblem problem = fem_problem(domain);
    const Eigen::MatrixXd truth = solve_finite_elements(problem);
    const Eigen::RowVectorXd scale = error_scale(problem, truth);
    DomainErrors result;
    result.cell_lambda = knot_errors(solved, solved.cell_lambda, truth, scale);
    result.lambda = knot_errors(solved, solved.lambda, truth, scale);

    const PatchSpace space(domain, solved.knots, solved.voronoi);
    const int rings = options.own.rings;
    for (const BasisChoice& choice : {BasisChoice{BasisKind::local, rings, true}, BasisChoice{BasisKind::green, rings, true},
                                      BasisChoice{BasisKind::green, rings, false}, BasisChoice{BasisKind::exact, rings, true}}) {
        const std::string name = basis_name(choice);
        Eigen::MatrixXd values;
        if (name == basis_name(options.own)) {
            values = by_vertex(own_table, own_values);
        } else if (choice.kind == BasisKind::green && !options.with_green) {
            continue;
        } else {
            enter("basis " + name);
            Program program;
            program.height_first = program.corner_first = {0};
            Field& field = program.fields.emplace_back();
            field.table = basis_table(space, solved.voronoi, choice, {options.threads, options.on_progress});
            field.coefficients =
                solve_coefficients(space, solved.voronoi, solved.system, field.table, choice, solved.cell_lambda).values;
            if (const Result<bool> valid = validate(program); !valid)
                throw Error(valid.error());
            values = by_vertex(field.table, evaluate_on_cpu(program, options.threads).values[0]);
        }
        result.bases.push_back({name, compare_fields(problem, truth, values)});
    }
    return result;
}

}  // namespace pvg::app
