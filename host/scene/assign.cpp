#include "scene/assign.h"

#include <algorithm>
#include <string_view>
#include <vector>

#include "pvg/status.h"
#include "scene/json_node.h"
#include "scene/json_text.h"

namespace pvg {
namespace {

using nlohmann::json;

struct Identified {
    std::string id;
    json* primitive;
};

/// All primitives that have an id, of a document that is not checked yet.
std::vector<Identified> identified_primitives(json& document) {
    std::vector<Identified> found;
    if (!document.is_object() || !document.contains("layers") || !document["layers"].is_array())
        return found;
    for (json& layer : document["layers"]) {
        if (!layer.is_object() || !layer.contains("primitives") || !layer["primitives"].is_array())
            continue;
        for (json& primitive : layer["primitives"]) {
            if (primitive.is_object() && primitive.contains("id") && primitive["id"].is_string()) {
                found.push_back({primitive["id"].get<std::string>(), &primitive});
            }
        }
    }
    return found;
}

json value_of(const std::string& text) {
    try {
        return parse_json_text(text, "");
    } catch (const Error&) {
        return json(text);
    }
}

std::vector<std::string> split_keys(std::string_view keys) {
    std::vector<std::string> parts;
    while (true) {
        const std::size_t dot = keys.find('.');
        parts.emplace_back(keys.substr(0, dot));
        if (dot == std::string_view::npos)
            return parts;
        keys.remove_prefix(dot + 1);
    }
}

bool is_index(const std::string& key) {
    return !key.empty() && key.size() <= 9 && std::all_of(key.begin(), key.end(), [](char c) { return c >= '0' && c <= '9'; });
}

}  // namespace

void apply_assignment(json& document, const std::string& assignment, const std::string& file) {
    const auto usage = [&](const std::string& message) {
        return Error(ErrorKind::usage, "--set " + assignment + ": " + message);
    };
    const std::size_t equals = assignment.find('=');
    if (equals == std::string::npos || assignment.find('.') == std::string::npos || assignment.find('.') == 0) {
        throw usage("expected ID.KEY[.KEY...]=VALUE");
    }

    // An id may hold dots and equals signs itself: the longest one that the assignment begins with is meant.
    const std::vector<Identified> primitives = identified_primitives(document);
    const Identified* target = nullptr;
    for (const Identified& candidate : primitives) {
        if (assignment.rfind(candidate.id + ".", 0) == 0 && (!target || candidate.id.size() > target->id.size()))
            target = &candidate;
    }
    if (!target) {
        const std::string id = assignment.substr(0, assignment.find('.'));
        if (primitives.empty())
            throw usage("no primitive of " + file + " has an id");
        std::vector<std::string_view> ids;
        for (const Identified& candidate : primitives) ids.push_back(candidate.id);
        const std::string_view near = nearest_word(id, ids);
        std::string message = "no primitive of " + file + " has the id \"" + id + "\"";
        if (!near.empty())
            message += ", did you mean \"" + std::string(near) + "\"?";
        std::string list;
        for (const std::string_view known : ids) list += (list.empty() ? "\"" : ", \"") + std::string(known) + "\"";
        throw usage(message + "; the ids are " + list);
    }

    const std::string rest = assignment.substr(target->id.size() + 1);
    const std::size_t sign = rest.find('=');
    if (sign == std::string::npos)
        throw usage("expected ID.KEY[.KEY...]=VALUE");
    const std::vector<std::string> keys = split_keys(std::string_view(rest).substr(0, sign));

    json* place = target->primitive;
    std::string walked = target->id;
    for (const std::string& key : keys) {
        if (key.empty())
            throw usage("expected a key between the dots, found none");
        if (place->is_null())
            *place = json::object();  // made on the way
        if (place->is_array()) {
            const std::size_t size = place->size();
            if (!is_index(key) || std::stoul(key) > size) {
                throw usage("expected an index from 0 to " + std::to_string(size) + " into " + walked + ", found \"" + key +
                            "\"");
            }
            const std::size_t index = std::stoul(key);
            if (index == size)
                place->push_back(nullptr);
            place = &(*place)[index];
        } else if (place->is_object()) {
            place = &(*place)[key];
        } else {
            throw usage(walked + " is " + describe_json(*place) + " and has no key \"" + key + "\"");
        }
        walked += "." + key;
    }
    *place = value_of(rest.substr(sign + 1));
}

}  // namespace pvg
