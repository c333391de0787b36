#include "scene/json_node.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "pvg/status.h"

namespace pvg {
namespace {

using nlohmann::json;

std::string dump(const json& value) { return value.dump(-1, ' ', false, json::error_handler_t::replace); }

std::string shorten(std::string text, std::size_t most) {
    if (text.size() <= most)
        return text;
    std::size_t cut = most;
    while (cut > 0 && (text[cut] & 0xC0) == 0x80) --cut;  // not inside a character
    return text.substr(0, cut) + "...";
}

/// A reference token of a JSON pointer (RFC 6901), control characters escaped as in a JSON string.
std::string pointer_token(const std::string& key) {
    const std::string text = dump(json(key));
    std::string token;
    for (std::size_t i = 1; i + 1 < text.size(); ++i) {
        if (text[i] == '~')
            token += "~0";
        else if (text[i] == '/')
            token += "~1";
        else
            token += text[i];
    }
    return shorten(token, 80);
}

std::string plain_number(double value) {
    std::ostringstream stream;
    stream << value;
    return stream.str();
}

}  // namespace

std::string describe_json(const json& value) {
    if (value.is_number_float() && !std::isfinite(value.get<double>()))
        return std::isnan(value.get<double>()) ? "NaN" : "infinity";
    if (value.is_object()) {
        return value.empty() ? "{}" : "an object with " + std::to_string(value.size()) + (value.size() == 1 ? " key" : " keys");
    }
    if (value.is_array()) {
        const bool flat = std::none_of(value.begin(), value.end(), [](const json& item) { return item.is_structured(); });
        if (flat && value.size() <= 8) {
            std::string text = dump(value);
            if (text.size() <= 60)
                return text;
        }
        return "an array of " + std::to_string(value.size());
    }
    if (value.is_string()) {
        const auto& text = value.get_ref<const std::string&>();
        if (text.size() > 60)
            return shorten(dump(json(shorten(text, 60))), 80);
    }
    return dump(value);
}

int edit_distance(std::string_view a, std::string_view b) {
    // Optimal string alignment, three rows.
    std::vector<int> older(b.size() + 1), above(b.size() + 1), row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) above[j] = static_cast<int>(j);
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = static_cast<int>(i);
        for (std::size_t j = 1; j <= b.size(); ++j) {
            row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                row[j] = std::min(row[j], older[j - 2] + 1);
        }
        std::swap(older, above);
        std::swap(above, row);
    }
    return above[b.size()];
}

std::string_view nearest_word(std::string_view word, const std::vector<std::string_view>& choices) {
    if (word.size() > 64)
        return {};
    std::string_view nearest;
    int best = std::max(2, static_cast<int>(word.size()) / 3) + 1;
    for (const std::string_view choice : choices) {
        const int distance = edit_distance(word, choice);
        // A word that shares no letter's place is no suggestion, however short both are.
        if (distance < best && distance < static_cast<int>(std::max(word.size(), choice.size()))) {
            best = distance;
            nearest = choice;
        }
    }
    return nearest;
}

std::string quoted_list(const std::vector<std::string_view>& words) {
    std::string list;
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (i > 0)
            list += i + 1 == words.size() ? " or " : ", ";
        list += '"' + std::string(words[i]) + '"';
    }
    return list;
}

void JsonNode::fail(const std::string& message) const {
    throw Error(ErrorKind::bad_input, *file_ + ": " + (pointer_.empty() ? "" : pointer_ + ": ") + message);
}

void JsonNode::expected(const std::string& what) const { fail("expected " + what + ", found " + describe_json(*value_)); }

JsonNode JsonNode::member(const std::string& key) const {
    JsonNode node(value_->at(key), *file_);
    node.pointer_ = pointer_ + "/" + pointer_token(key);
    return node;
}

JsonNode JsonNode::element(std::size_t index) const {
    JsonNode node(value_->at(index), *file_);
    node.pointer_ = pointer_ + "/" + std::to_string(index);
    return node;
}

void JsonNode::check_object(const std::vector<std::string_view>& required, const std::vector<std::string_view>& optional) const {
    std::vector<std::string_view> known = required;
    known.insert(known.end(), optional.begin(), optional.end());
    if (!value_->is_object())
        expected("an object");
    for (const auto& [key, value] : value_->items()) {
        if (std::find(known.begin(), known.end(), key) != known.end())
            continue;
        const std::string_view near = nearest_word(key, known);
        member(key).fail("unknown key" + (near.empty() ? "; the keys here are " + quoted_list(known)
                                                       : ", did you mean \"" + std::string(near) + "\"?"));
    }
    for (const std::string_view key : required) {
        if (!has(std::string(key)))
            fail("expected the key \"" + std::string(key) + "\", found none");
    }
}

void JsonNode::check_array(const std::string& what) const {
    if (!value_->is_array())
        expected(what);
}

double JsonNode::number(const NumberRange& range) const {
    std::string limits(range.meaning);
    if (range.low > -1e30)
        limits += (range.open_low ? " > " : " >= ") + plain_number(range.low);
    if (range.high < 1e30)
        limits += (range.low > -1e30 ? " and" : "") + std::string(range.open_high ? " < " : " <= ") + plain_number(range.high);
    if (!value_->is_number())
        expected(limits);
    const double number = value_->get<double>();
    if (!std::isfinite(number) || std::abs(number) > 1e30)
        expected(limits + (limits == range.meaning ? " between -1e30 and 1e30" : ""));
    const bool inside = (range.open_low ? number > range.low : number >= range.low) &&
                        (range.open_high ? number < range.high : number <= range.high);
    if (!inside)
        expected(limits);
    return number;
}

int JsonNode::integer(int low, int high) const {
    const std::string what = "a whole number " + (high == std::numeric_limits<int>::max()
                                                      ? ">= " + std::to_string(low)
                                                      : "from " + std::to_string(low) + " to " + std::to_string(high));
    if (!value_->is_number_integer())
        expected(what);
    if (value_->is_number_unsigned() ? value_->get<std::uint64_t>() > static_cast<std::uint64_t>(high)
                                     : value_->get<std::int64_t>() > high)
        expected(what);
    if (!value_->is_number_unsigned() && value_->get<std::int64_t>() < low)
        expected(what);
    const int number = value_->get<int>();
    if (number < low)
        expected(what);
    return number;
}

bool JsonNode::boolean() const {
    if (!value_->is_boolean())
        expected("true or false");
    return value_->get<bool>();
}

std::string JsonNode::text(const std::string& what) const {
    if (!value_->is_string() || value_->get_ref<const std::string&>().empty())
        expected(what);
    const auto& text = value_->get_ref<const std::string&>();
    if (text.find('\0') != std::string::npos)
        expected(what + " without a NUL character");
    return text;
}

int JsonNode::choice(std::initializer_list<std::string_view> choices) const {
    const std::vector<std::string_view> words(choices);
    if (value_->is_string()) {
        const auto at = std::find(words.begin(), words.end(), value_->get_ref<const std::string&>());
        if (at != words.end())
            return static_cast<int>(at - words.begin());
    }
    expected(quoted_list(words));
}

}  // namespace pvg
