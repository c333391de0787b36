// A value of a JSON document with its place, and what the scene's checks need of it. Every complaint reads
// "FILE: POINTER: expected ..., found ...".
#pragma once

#include <initializer_list>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace pvg {

/// Limits of a number; exclusive ones where `open_*` says so.
struct NumberRange {
    double low = -1e30;
    double high = 1e30;
    bool open_low = false;
    bool open_high = false;
    std::string_view meaning = "a number";  ///< what the message expects
};

class JsonNode {
public:
    /// The whole document. Both referents outlive the node.
    JsonNode(const nlohmann::json& value, const std::string& file) : value_(&value), file_(&file) {}

    const nlohmann::json& value() const { return *value_; }
    const std::string& pointer() const { return pointer_; }

    /// Throws Error(bad_input) "FILE: POINTER: message".
    [[noreturn]] void fail(const std::string& message) const;
    /// The same with "expected ..., found ...".
    [[noreturn]] void expected(const std::string& what) const;

    bool has(const std::string& key) const { return value_->contains(key); }
    JsonNode member(const std::string& key) const;  ///< requires has(key)
    JsonNode element(std::size_t index) const;
    std::size_t size() const { return value_->size(); }

    /// Checks that it is an object, that each key is one of these, and that the required ones are there.
    void check_object(const std::vector<std::string_view>& required, const std::vector<std::string_view>& optional) const;
    void check_array(const std::string& what) const;

    double number(const NumberRange& range = {}) const;
    int integer(int low, int high) const;
    bool boolean() const;
    std::string text(const std::string& what) const;  ///< a string that is not empty
    /// The index of the string among the choices.
    int choice(std::initializer_list<std::string_view> choices) const;

private:
    const nlohmann::json* value_;
    const std::string* file_;
    std::string pointer_;
};

/// A value as messages show it: short ones whole, long ones by kind and size.
std::string describe_json(const nlohmann::json& value);
/// Edit distance in bytes: insertions, deletions, substitutions and swaps of neighbours count 1.
int edit_distance(std::string_view a, std::string_view b);
/// The choice nearest to `word`, or an empty view where none is near (more than a third of the letters differ).
std::string_view nearest_word(std::string_view word, const std::vector<std::string_view>& choices);
/// "a", "b" or "c"
std::string quoted_list(const std::vector<std::string_view>& words);

}  // namespace pvg
