#include "gltf/document.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pvg::gltf {
namespace {

std::string escaped(std::string_view key) {
    std::string result;
    for (char c : key) {
        if (c == '~')
            result += "~0";
        else if (c == '/')
            result += "~1";
        else
            result += c;
    }
    return result;
}

std::string found(const Json& json) {
    if (json.is_structured())
        return json.is_object() ? "an object" : "an array";
    std::string text = json.dump(-1, ' ', true, Json::error_handler_t::replace);
    if (text.size() > 40)
        text = text.substr(0, 37) + "...";
    return text;
}

}  // namespace

void Place::fail(const std::string& what) const {
    throw Error(ErrorKind::bad_input, *file_ + ": " + (pointer_.empty() ? "/" : pointer_) + ": " + what);
}

Place Place::at(const char* key) const {
    Place place(*file_, json_->at(key));
    place.pointer_ = pointer_ + "/" + escaped(key);
    return place;
}

Place Place::at(std::size_t index) const {
    Place place(*file_, json_->at(index));
    place.pointer_ = pointer_ + "/" + std::to_string(index);
    return place;
}

const Place& Place::expect_object() const {
    if (!json_->is_object())
        fail("expected an object, found " + found(*json_));
    return *this;
}

std::optional<Place> Place::object(const char* key) const {
    if (!has(key))
        return std::nullopt;
    const Place place = at(key);
    place.expect_object();
    return place;
}

std::optional<Place> Place::array(const char* key) const {
    if (!has(key))
        return std::nullopt;
    const Place place = at(key);
    if (!place.json_->is_array())
        place.fail("expected an array, found " + found(*place.json_));
    return place;
}

std::uint64_t Place::integer(std::uint64_t least, std::uint64_t most) const {
    const auto refuse = [&] [[noreturn]] () {
        std::string range = most == UINT64_MAX ? "at least " + std::to_string(least)
                            : least == most    ? std::to_string(least)
                                               : "from " + std::to_string(least) + " to " + std::to_string(most);
        fail("expected an integer " + range + ", found " + found(*json_));
    };
    std::uint64_t value = 0;
    if (json_->is_number_unsigned()) {
        value = json_->get<std::uint64_t>();
    } else if (json_->is_number_integer()) {
        const auto number = json_->get<std::int64_t>();
        if (number < 0)
            refuse();
        value = static_cast<std::uint64_t>(number);
    } else if (json_->is_number_float()) {
        const double number = json_->get<double>();
        if (!(number >= 0 && number <= 9007199254740992.0) || std::floor(number) != number)
            refuse();
        value = static_cast<std::uint64_t>(number);
    } else {
        refuse();
    }
    if (value < least || value > most)
        refuse();
    return value;
}

std::uint64_t Place::integer(const char* key, std::uint64_t least, std::uint64_t most) const {
    if (!has(key))
        fail("\"" + std::string(key) + "\" is missing");
    return at(key).integer(least, most);
}

std::uint64_t Place::integer(const char* key, std::uint64_t least, std::uint64_t most, std::uint64_t otherwise) const {
    return has(key) ? at(key).integer(least, most) : otherwise;
}

std::size_t Place::index(const char* key, std::size_t count, const char* what) const {
    const std::uint64_t value = integer(key, 0, UINT64_MAX);
    if (value >= count)
        at(key).fail(std::to_string(value) + " is not one of the file's " + std::to_string(count) + " " + what);
    return static_cast<std::size_t>(value);
}

std::string Place::text(const char* key) const {
    if (!has(key))
        fail("\"" + std::string(key) + "\" is missing");
    const Place place = at(key);
    if (!place.json_->is_string())
        place.fail("expected a string, found " + found(*place.json_));
    return place.json_->get<std::string>();
}

bool Place::boolean(const char* key, bool otherwise) const {
    if (!has(key))
        return otherwise;
    const Place place = at(key);
    if (!place.json_->is_boolean())
        place.fail("expected true or false, found " + found(*place.json_));
    return place.json_->get<bool>();
}

Json parse_json(const std::string& file, std::string_view text) {
    if (text.substr(0, 3) == "\xef\xbb\xbf")
        throw Error(ErrorKind::bad_input, file + ": /: the JSON starts with a byte order mark; glTF wants plain UTF-8");
    // Nesting is measured before parsing: a deep document must not even be built, since it is taken down recursively.
    int depth = 0;
    std::array<std::size_t, deepest_json + 1> members{};
    bool in_string = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (in_string) {
            if (c == '\\')
                ++i;
            else if (c == '"')
                in_string = false;
        } else if (c == '"') {
            in_string = true;
        } else if (c == '[' || c == '{') {
            if (++depth > deepest_json)
                throw Error(ErrorKind::bad_input, file + ": /: the JSON nests more than " + std::to_string(deepest_json) +
                                                      " deep at byte " + std::to_string(i));
            members[static_cast<std::size_t>(depth)] = c == '{' ? 1 : 0;
        } else if (c == ']' || c == '}') {
            // More brackets closed than opened: the parser will say where.
            depth = std::max(depth - 1, 0);
        } else if (c == ',' && members[static_cast<std::size_t>(depth)] > 0 &&
                   ++members[static_cast<std::size_t>(depth)] > most_members) {
            throw Error(ErrorKind::bad_input, file + ": /: an object with more than " + std::to_string(most_members) +
                                                  " members at byte " + std::to_string(i));
        }
    }
    try {
        return Json::parse(text);
    } catch (const nlohmann::json::exception& error) {
        std::string what = error.what();
        if (const auto end = what.find("] "); end != std::string::npos)
            what = what.substr(end + 2);
        throw Error(ErrorKind::bad_input, file + ": /: not valid JSON: " + what);
    }
}

}  // namespace pvg::gltf
