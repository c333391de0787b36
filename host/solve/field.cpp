#include "solve/field.h"

#include <algorithm>

#include "solve/basis.h"
#include "solve/bounds.h"
#include "solve/galerkin.h"
#include "solve/given_values.h"
#include "solve/green_basis.h"

namespace pvg {
namespace {

/// Rows by Voronoi cell, as in the other tables, four at a time.
Table identity_table(const PatchSpace& space) {
    Table table;
    const int vertices = space.domain.surface.vertex_count(), cells = static_cast<int>(space.knots.vertex.size());
    table.row_count = table.coefficient_count = static_cast<std::uint32_t>(vertices);
    table.channels = static_cast<std::uint32_t>(space.domain.channels);
    table.cell_first_row.push_back(0);
    table.cell_first_index.push_back(0);
    table.cell_first_weight.push_back(0);
    const auto add_rows = [&](std::uint32_t count) {
        const std::uint32_t first = table.cell_first_row.back();
        for (std::uint32_t i = 0; i < 4; ++i) table.indices.push_back(first + std::min(i, count - 1));
        for (std::uint32_t row = 0; row < count; ++row)
            for (std::uint32_t i = 0; i < 4; ++i) table.weights.push_back(i == row ? 1.0f : 0.0f);
        ++table.cell_count;
        table.cell_first_row.push_back(first + count);
        table.cell_first_index.push_back(static_cast<std::uint32_t>(table.indices.size()));
        table.cell_first_weight.push_back(static_cast<std::uint32_t>(table.weights.size()));
    };
    const auto add_vertices = [&](const std::vector<int>& list) {
        for (int v : list) table.row_vertex.push_back(static_cast<std::uint32_t>(v));
        for (std::size_t i = 0; i < list.size(); i += 4)
            add_rows(static_cast<std::uint32_t>(std::min<std::size_t>(4, list.size() - i)));
    };
    std::vector<char> has_row(vertices, 0);
    for (int v : space.cell_vertices) has_row[v] = 1;
    for (int c = 0; c < cells; ++c)
        add_vertices({space.cell_vertices.begin() + space.cell_first[c], space.cell_vertices.begin() + space.cell_first[c + 1]});
    std::vector<int> alone;  // vertices without faces
    for (int v = 0; v < vertices; ++v)
        if (!has_row[v])
            alone.push_back(v);
    add_vertices(alone);
    table.vertex_row.assign(vertices, 0);
    for (std::size_t row = 0; row < table.row_vertex.size(); ++row)
        table.vertex_row[table.row_vertex[row]] = static_cast<std::uint32_t>(row);
    return table;
}

std::vector<float> vertex_values(const Eigen::MatrixXd& u, const Eigen::MatrixXd& lambda, const PatchSpace& space,
                                 const Table& table) {
    const Domain& domain = space.domain;
    const auto coupled = [&](std::uint32_t v) { return space.partner[v] != none && space.knots.knot_of_vertex[v] != none; };
    std::vector<float> all;
    all.reserve(static_cast<std::size_t>(u.size()));
    for (std::uint32_t v : table.row_vertex)
        for (int c = 0; c < domain.channels; ++c)
            all.push_back(static_cast<float>(domain.dirichlet[v] ? domain.dirichlet_value(v, c)
                                             : coupled(v)        ? lambda(space.knots.knot_of_vertex[v], c)
                                                                 : u(v, c)));
    return all;
}

}  // namespace

Table basis_table(const PatchSpace& space, const Voronoi& voronoi, const BasisChoice& choice, const FieldOptions& options) {
    switch (choice.kind) {
        case BasisKind::green:
            return GreenBasis(space, voronoi)
                .table({.rings = choice.rings,
                        .normalize = choice.normalize,
                        .threads = options.threads,
                        .on_progress = options.on_progress});
        case BasisKind::exact:
            return identity_table(space);
        case BasisKind::local:
            break;
    }
    return local_basis(space, {.rings = choice.rings, .threads = options.threads});
}

Coefficients solve_coefficients(const PatchSpace& space, const Voronoi& voronoi, const System& system, const Table& table,
                                const BasisChoice& choice, const Eigen::MatrixXd& cell_lambda, int threads) {
    Coefficients result{cell_lambda, cell_lambda, {}, {}};
    if (choice.kind == BasisKind::exact) {
        result.values = vertex_values(GreenBasis(space, voronoi).sum(cell_lambda), cell_lambda, space, table);
        return result;
    }
    const Eigen::MatrixXd source = given_values(space.domain, space.knots.vertex).source;
    if (choice.kind == BasisKind::local) {
        result.matrix = galerkin_matrix(space, table, static_cast<int>(cell_lambda.rows()), threads);
        minimise_energy(result.matrix, system, source, {.threads = threads}, result.unbounded);
        result.lambda = result.unbounded;
        if (system.unknowns() > 0)
            keep_between_bounds(space.domain, space.knots, result.lambda);
    }
    result.values = coefficient_values(result.lambda, source);
    return result;
}

std::vector<float> coefficient_values(const Eigen::MatrixXd& lambda, const Eigen::MatrixXd& source) {
    std::vector<float> all;
    all.reserve(static_cast<std::size_t>(lambda.size() + source.size()));
    for (const Eigen::MatrixXd* rows : {&lambda, &source})
        for (Eigen::Index j = 0; j < rows->rows(); ++j)
            for (Eigen::Index c = 0; c < rows->cols(); ++c) all.push_back(static_cast<float>((*rows)(j, c)));
    return all;
}

}  // namespace pvg
