// Words and numbers of text formats, with the line for messages.
#pragma once

#include <array>
#include <cmath>
#include <charconv>
#include <string>
#include <string_view>
#include <vector>

#include "pvg/status.h"

namespace pvg::gltf {

/// Lines of a text, split into words at white space; from `comment` on a line is ignored.
class TextLines {
public:
    TextLines(const std::string& file, std::string_view text, char comment) : file_(&file), text_(text), comment_(comment) {}

    /// The next line, blank or not; false at the end.
    bool next() {
        if (at_ >= text_.size())
            return false;
        std::size_t end = text_.find('\n', at_);
        if (end == std::string_view::npos)
            end = text_.size();
        std::string_view line = text_.substr(at_, end - at_);
        at_ = end + 1;
        ++number_;
        line = line.substr(0, line.find(comment_));
        words.clear();
        for (std::size_t i = 0; i < line.size();) {
            while (i < line.size() && is_space(line[i])) ++i;
            std::size_t j = i;
            while (j < line.size() && !is_space(line[j])) ++j;
            if (j > i)
                words.push_back(line.substr(i, j - i));
            i = j;
        }
        return true;
    }
    /// The next line that is not blank.
    bool next_filled() {
        while (next())
            if (!words.empty())
                return true;
        words.clear();
        return false;
    }

    [[noreturn]] void fail(const std::string& what) const {
        throw Error(ErrorKind::bad_input, *file_ + ": line " + std::to_string(number_) + ": " + what);
    }

    /// Word `i` as a finite number within float's range.
    double number(std::size_t i) const {
        if (i >= words.size())
            fail("expected " + std::to_string(i + 1) + " values, found " + std::to_string(words.size()));
        std::string_view word = words[i];
        if (word.size() > 1 && word[0] == '+')
            word.remove_prefix(1);
        double value = 0;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        // Too small for a double is zero enough; anything else that does not parse is refused.
        if (end != word.data() + word.size() || (error == std::errc::result_out_of_range && std::abs(value) > 1) ||
            error == std::errc::invalid_argument)
            fail("expected a number, found \"" + shown(word) + "\"");
        if (!std::isfinite(value) || std::abs(value) > 3.4028234e38)
            fail("expected a finite number, found \"" + shown(word) + "\"");
        return value;
    }
    long long integer(std::size_t i) const {
        if (i >= words.size())
            fail("expected " + std::to_string(i + 1) + " values, found " + std::to_string(words.size()));
        return integer(words[i]);
    }
    long long integer(std::string_view word) const {
        long long value = 0;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (error != std::errc() || end != word.data() + word.size())
            fail("expected an integer, found \"" + shown(word) + "\"");
        return value;
    }
    std::array<float, 3> vector(std::size_t first) const {
        return {static_cast<float>(number(first)), static_cast<float>(number(first + 1)), static_cast<float>(number(first + 2))};
    }

    std::vector<std::string_view> words;

    static std::string shown(std::string_view word) {
        std::string text;
        for (char c : word.substr(0, 40)) text += c >= ' ' && c < 127 ? c : '?';
        return text;
    }

private:
    static bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v'; }

    const std::string* file_;
    std::string_view text_;
    char comment_;
    std::size_t at_ = 0, number_ = 0;
};

/// Colours of these formats are sRGB by habit; glTF's vertex colours are linear.
inline float linear_from_srgb(double s) {
    return static_cast<float>(s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4));
}

}  // namespace pvg::gltf
