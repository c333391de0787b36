// What an evaluator runs: tables with their coefficients, and the output vertices whose displacement and
// normals follow from the evaluated heights. Plain arrays, owned by the caller of an evaluator.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pvg/status.h"
#include "pvg/table.h"

namespace pvg {

/// One domain's table and the coefficients it is evaluated with.
struct Field {
    Table table;
    std::vector<float> coefficients;  ///< coefficient_count x channels, row-major
};

/// A height that displaces a vertex: channel `channel` of row `row` of field `field`.
struct HeightTerm {
    std::uint32_t field = 0;
    std::uint32_t row = 0;
    std::uint32_t channel = 0;
};

/// n vertices, m shading normals.
/// position[i] = base[i] + (sum of height terms of i, in order) * unit * normal[i]; a vertex without terms is base[i] exactly.
/// shading normal[k] = normalised sum over its corners (a; b, c) of cross(b - a, c - a) / (|b - a|^2 |c - a|^2)
/// with displaced positions (N. Max, "Weights for computing vertex normals from facet normals", 1999).
struct Program {
    std::vector<Field> fields;

    std::vector<std::array<float, 3>> base;    ///< n
    std::vector<std::array<float, 3>> normal;  ///< n, unit: displacement direction
    float unit = 1;                            ///< mesh length of height 1
    std::vector<std::uint32_t> height_first;   ///< n + 1: terms of vertex i are height_terms[first[i] .. first[i + 1])
    std::vector<HeightTerm> height_terms;

    std::vector<std::uint32_t> corner_first;            ///< m + 1
    std::vector<std::array<std::uint32_t, 3>> corners;  ///< (a, b, c): vertex and its next two in face order
};

/// What an evaluator gives back, all on the host.
struct Evaluation {
    std::vector<std::vector<float>> values;      ///< per field: rows x channels, row-major, in row order of its table
    std::vector<float> height;                   ///< n: sum of height terms (the scene's number)
    std::vector<std::array<float, 3>> position;  ///< n
    std::vector<std::array<float, 3>> normal;    ///< m, unit (0 where a vertex has no area around it)
};

/// Checks every index, size and number of a program (tables included). Returns an error naming the first broken rule.
Result<bool> validate(const Program& program);

}  // namespace pvg
