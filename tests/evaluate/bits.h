// Evaluations compared bit for bit.
#pragma once

#include <cstring>
#include <string>

#include "pvg/program.h"

namespace pvg::test {

template <typename T>
std::string first_difference(const char* what, const std::vector<T>& a, const std::vector<T>& b) {
    if (a.size() != b.size())
        return std::string(what) + ": " + std::to_string(a.size()) + " and " + std::to_string(b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (std::memcmp(&a[i], &b[i], sizeof(T)) != 0)
            return std::string(what) + " " + std::to_string(i);
    }
    return {};
}

/// Empty when all bits agree, else the first array and element that differ.
inline std::string first_difference(const Evaluation& a, const Evaluation& b) {
    if (a.values.size() != b.values.size())
        return "fields";
    for (std::size_t f = 0; f < a.values.size(); ++f) {
        const std::string text = first_difference("values", a.values[f], b.values[f]);
        if (!text.empty())
            return "field " + std::to_string(f) + " " + text;
    }
    if (std::string text = first_difference("height", a.height, b.height); !text.empty())
        return text;
    if (std::string text = first_difference("position", a.position, b.position); !text.empty())
        return text;
    return first_difference("normal", a.normal, b.normal);
}

}  // namespace pvg::test
