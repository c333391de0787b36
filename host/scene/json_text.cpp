#include "scene/json_text.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <vector>

#include "pvg/status.h"

namespace pvg {
namespace {

std::string place(std::string_view text, std::size_t offset) {
    const std::string_view before = text.substr(0, std::min(offset, text.size()));
    const auto lines = std::count(before.begin(), before.end(), '\n');
    const std::size_t newline = before.rfind('\n');
    const std::string_view line = newline == std::string_view::npos ? before : before.substr(newline + 1);
    // Continuation bytes of UTF-8 are no characters of their own.
    const auto column = 1 + std::count_if(line.begin(), line.end(), [](char c) { return (c & 0xC0) != 0x80; });
    return "line " + std::to_string(1 + lines) + ", column " + std::to_string(column);
}

/// Builds the document itself, so that nesting stays bounded while it is read and no key is silently replaced.
class DocumentBuilder {
public:
    using json = nlohmann::json;
    using number_integer_t = json::number_integer_t;
    using number_unsigned_t = json::number_unsigned_t;
    using number_float_t = json::number_float_t;
    using string_t = json::string_t;
    using binary_t = json::binary_t;

    json document;
    std::string error;  ///< what is wrong, empty when nothing is
    std::size_t error_offset = 0;
    bool has_offset = false;
    std::size_t error_back = 0;  ///< characters between the error and what was read last, when there is no offset

    bool null() { return put(nullptr); }
    bool boolean(bool value) { return put(value); }
    bool number_integer(number_integer_t value) { return put(value); }
    bool number_unsigned(number_unsigned_t value) { return put(value); }
    bool number_float(number_float_t value, const string_t&) { return put(value); }
    bool string(string_t& value) { return put(std::move(value)); }
    bool binary(binary_t&) { return stop("binary values are not JSON"); }
    bool start_object(std::size_t) { return open(json::object()); }
    bool start_array(std::size_t) { return open(json::array()); }
    bool end_object() { return close(); }
    bool end_array() { return close(); }
    bool key(string_t& value) {
        if (open_.back()->contains(value)) {
            return stop("the key " + json(value).dump(-1, ' ', false, json::error_handler_t::replace) +
                        " appears twice in one object");
        }
        key_ = std::move(value);
        return true;
    }
    bool parse_error(std::size_t position, const std::string&, const json::exception& exception) {
        std::string what = exception.what();
        // "[json.exception...] parse error at line 1, column 2: reason": the place is given in front, in characters.
        const std::size_t bracket = what.find("] ");
        if (bracket != std::string::npos)
            what.erase(0, bracket + 2);
        if (what.rfind("parse error", 0) == 0) {
            const std::size_t colon = what.find(": ");
            if (colon != std::string::npos)
                what.erase(0, colon + 2);
        }
        // Bytes that are no UTF-8 must not travel in a message.
        if (what.find("UTF-8") != std::string::npos)
            what.erase(std::min(what.size(), what.find("; last read")));
        error = what;
        error_offset = position > 0 ? position - 1 : 0;
        // A number too large for a double comes without a place; it ends before the character that was read last.
        has_offset = exception.id != 406;
        if (!has_offset)
            error_back = 1;
        return false;
    }

private:
    std::vector<json*> open_;
    std::string key_;

    json* add(json value) {
        if (open_.empty()) {
            document = std::move(value);
            return &document;
        }
        json& parent = *open_.back();
        if (parent.is_array()) {
            parent.push_back(std::move(value));
            return &parent.back();
        }
        json& slot = parent[key_];
        slot = std::move(value);
        return &slot;
    }
    template <typename T>
    bool put(T&& value) {
        add(json(std::forward<T>(value)));
        return true;
    }
    bool open(json container) {
        if (open_.size() >= static_cast<std::size_t>(max_json_depth)) {
            return stop("objects and arrays nest deeper than " + std::to_string(max_json_depth));
        }
        // A parent's storage does not move while a child is open: nothing is added to it meanwhile.
        open_.push_back(add(std::move(container)));
        return true;
    }
    bool close() {
        open_.pop_back();
        return true;
    }
    bool stop(std::string reason) {
        error = std::move(reason);
        return false;
    }
};

/// Iterates over the text and tells how far the parser has read, for errors that come without a position.
struct CountingIterator {
    using iterator_category = std::input_iterator_tag;
    using value_type = char;
    using difference_type = std::ptrdiff_t;
    using pointer = const char*;
    using reference = const char&;

    const char* at = nullptr;
    const char** reached = nullptr;

    const char& operator*() const { return *at; }
    CountingIterator& operator++() {
        *reached = ++at;
        return *this;
    }
    CountingIterator operator++(int) {
        CountingIterator before = *this;
        ++*this;
        return before;
    }
    bool operator==(const CountingIterator& other) const { return at == other.at; }
    bool operator!=(const CountingIterator& other) const { return at != other.at; }
};

}  // namespace

nlohmann::json parse_json_text(std::string_view text, const std::string& name) {
    DocumentBuilder builder;
    const char* reached = text.data();
    const CountingIterator begin{text.data(), &reached};
    const CountingIterator end{text.data() + text.size(), &reached};
    if (!nlohmann::json::sax_parse(begin, end, &builder)) {
        const auto read = static_cast<std::size_t>(reached - text.data());
        const std::size_t offset =
            builder.has_offset ? builder.error_offset : (read > builder.error_back ? read - 1 - builder.error_back : 0);
        throw Error(ErrorKind::bad_input, name + ": " + place(text, offset) + ": " + builder.error);
    }
    return std::move(builder.document);
}

std::string read_text_file(const std::filesystem::path& file) {
    std::error_code code;
    const auto status = std::filesystem::status(file, code);
    if (!std::filesystem::exists(status))
        throw Error(ErrorKind::bad_input, file.string() + ": no such file");
    if (!std::filesystem::is_regular_file(status))
        throw Error(ErrorKind::bad_input, file.string() + ": expected a regular file");
    std::ifstream stream(file, std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(stream), {}};
    if (!stream.good() && !stream.eof())
        throw Error(ErrorKind::bad_input, file.string() + ": cannot be read");
    return text;
}

}  // namespace pvg
