#include "pvg/program.h"

#include <cmath>
#include <string>

namespace pvg {
namespace {

Error broken(const std::string& rule) { return Error(ErrorKind::bad_input, "program: " + rule); }

std::string number(std::uint64_t value) { return std::to_string(value); }

std::string broken_vectors(const char* name, const std::vector<std::array<float, 3>>& vectors) {
    for (std::size_t i = 0; i < vectors.size(); ++i)
        for (float x : vectors[i])
            if (!std::isfinite(x))
                return std::string(name) + "[" + number(i) + "] is not finite";
    return {};
}

std::string broken_ranges(const char* name, const std::vector<std::uint32_t>& first, std::uint64_t count, std::uint64_t size) {
    const std::string who = name;
    if (first.size() != count + 1)
        return who + " has " + number(first.size()) + " entries, expected " + number(count + 1);
    if (first.front() != 0)
        return who + " starts at " + number(first.front()) + ", expected 0";
    for (std::size_t i = 0; i < count; ++i)
        if (first[i + 1] < first[i])
            return who + " falls at " + number(i);
    if (first.back() != size)
        return who + " ends at " + number(first.back()) + ", expected " + number(size);
    return {};
}

}  // namespace

Result<bool> validate(const Program& program) {
    for (std::size_t f = 0; f < program.fields.size(); ++f) {
        const Field& field = program.fields[f];
        const std::string place = "fields[" + number(f) + "]";
        if (const Result<bool> table = validate(field.table); !table)
            return broken(place + ": " + table.error().what());
        const std::uint64_t size = std::uint64_t{field.table.coefficient_count} * field.table.channels;
        if (field.coefficients.size() != size)
            return broken(place + " has " + number(field.coefficients.size()) +
                          " coefficients, expected coefficient_count x channels = " + number(size));
        for (std::size_t i = 0; i < field.coefficients.size(); ++i)
            if (!std::isfinite(field.coefficients[i]))
                return broken(place + ": coefficients[" + number(i) + "] is not finite");
    }

    const std::size_t vertices = program.base.size();
    if (program.normal.size() != vertices)
        return broken("normal has " + number(program.normal.size()) + " entries, expected as many as base");
    std::string rule = broken_vectors("base", program.base);
    if (rule.empty())
        rule = broken_vectors("normal", program.normal);
    if (!rule.empty())
        return broken(rule);
    if (!std::isfinite(program.unit))
        return broken("unit is not finite");

    rule = broken_ranges("height_first", program.height_first, vertices, program.height_terms.size());
    if (!rule.empty())
        return broken(rule);
    for (std::size_t i = 0; i < program.height_terms.size(); ++i) {
        const HeightTerm& term = program.height_terms[i];
        const std::string place = "height_terms[" + number(i) + "]";
        if (term.field >= program.fields.size())
            return broken(place + ".field = " + number(term.field) + ", expected below " + number(program.fields.size()));
        const Table& table = program.fields[term.field].table;
        if (term.row >= table.row_count)
            return broken(place + ".row = " + number(term.row) + ", expected below " + number(table.row_count));
        if (term.channel >= table.channels)
            return broken(place + ".channel = " + number(term.channel) + ", expected below " + number(table.channels));
    }

    if (program.corner_first.empty())
        return broken("corner_first is empty, expected one entry more than shading normals");
    rule = broken_ranges("corner_first", program.corner_first, program.corner_first.size() - 1, program.corners.size());
    if (!rule.empty())
        return broken(rule);
    for (std::size_t i = 0; i < program.corners.size(); ++i)
        for (std::uint32_t vertex : program.corners[i])
            if (vertex >= vertices)
                return broken("corners[" + number(i) + "] names vertex " + number(vertex) + ", expected below " +
                              number(vertices));
    return true;
}

}  // namespace pvg
