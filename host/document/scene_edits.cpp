#include "document/scene_edits.h"

#include <string_view>

#include "scene/json_node.h"
#include "scene/json_text.h"

namespace pvg {
namespace {

using nlohmann::json;

Error usage(const std::string& message) { return Error(ErrorKind::usage, message); }

std::string counted(std::size_t count, const char* what) { return std::to_string(count) + " " + what + (count == 1 ? "" : "s"); }

/// The primitives array and the place in it that a JSON pointer names, "/layers/L/primitives/P".
std::optional<std::pair<json*, std::size_t>> place_of_pointer(json& document, const std::string& pointer) {
    std::size_t layer = 0, primitive = 0;
    int read = 0;
    if (std::sscanf(pointer.c_str(), "/layers/%zu/primitives/%zu%n", &layer, &primitive, &read) != 2 ||
        static_cast<std::size_t>(read) != pointer.size())
        return std::nullopt;
    json& layers = document["layers"];
    if (layer >= layers.size() || primitive >= layers[layer]["primitives"].size())
        return std::nullopt;
    return std::pair{&layers[layer]["primitives"], primitive};
}

std::pair<json*, std::size_t> place_of(json& document, const std::string& name, const std::string& file) {
    std::vector<std::string> ids;
    for (json& layer : document["layers"])
        for (std::size_t p = 0; p < layer["primitives"].size(); ++p) {
            const json& primitive = layer["primitives"][p];
            if (!primitive.contains("id"))
                continue;
            ids.push_back(primitive["id"].get<std::string>());
            if (ids.back() == name)
                return {&layer["primitives"], p};
        }
    if (const auto place = place_of_pointer(document, name))
        return *place;
    std::string message = "no primitive of " + file + " has the id or the pointer \"" + name + "\"";
    const std::string_view near = nearest_word(name, {ids.begin(), ids.end()});
    if (!near.empty())
        message += ", did you mean \"" + std::string(near) + "\"?";
    throw usage(message);
}

const char* key_of(const json& primitive, Part part) {
    switch (part) {
        case Part::left:
            return "left";
        case Part::right:
            return "right";
        case Part::jump:
            return "jump";
        case Part::region:
            break;
    }
    return primitive.contains("rise") ? "rise" : "laplacian";
}

const char* kind_of(Part part) {
    return part == Part::jump ? "poisson_curve" : part == Part::region ? "poisson_region" : "diffusion_curve";
}

/// The value of the part's key, made when `make` is set.
json& part_of(json& primitive, Part part, const std::string& name, bool make) {
    const char* key = key_of(primitive, part);
    if (primitive["kind"] != kind_of(part))
        throw usage(name + " has no \"" + key + "\": expected a " + kind_of(part) + ", found a " +
                    primitive["kind"].get<std::string>());
    if (!make && !primitive.contains(key))
        throw usage(name + " gives no \"" + std::string(key) + "\": it is open on that side; set_stops gives it a value");
    return primitive[key];
}

json to_json(Part part, const ValueStop& stop, bool with_t) {
    json value = json::object();
    if (with_t)
        value["t"] = stop.t;
    if (stop.color)
        value["color"] = written_color(part, *stop.color);
    if (stop.height)
        value["height"] = *stop.height;
    return value;
}

}  // namespace

json written_color(Part part, const std::array<double, 4>& color) {
    if (part == Part::jump || part == Part::region)
        return {color[0], color[1], color[2]};
    return color[3] == 1 ? json{color[0], color[1], color[2]} : json{color[0], color[1], color[2], color[3]};
}

json& find_primitive(json& document, const std::string& name, const std::string& file) {
    const auto [list, index] = place_of(document, name, file);
    return (*list)[index];
}

json& find_stop(json& primitive, Part part, std::size_t stop, const std::string& name) {
    json& value = part_of(primitive, part, name, false);
    const std::size_t count = value.is_array() ? value.size() : 1;
    if (stop >= count)
        throw usage(name + ": expected a stop below " + std::to_string(count) + " (\"" + key_of(primitive, part) + "\" has " +
                    counted(count, "stop") + "), found " + std::to_string(stop));
    return value.is_array() ? value[stop] : value;
}

void replace_stops(json& primitive, Part part, const std::vector<ValueStop>& stops, const std::string& name) {
    json& value = part_of(primitive, part, name, true);
    if (stops.empty()) {
        primitive.erase(key_of(primitive, part));
        return;
    }
    if (part == Part::region && stops.size() > 1)
        throw usage(name + ": expected one value of the region, found " + counted(stops.size(), "stop"));
    if (part == Part::region || (stops.size() == 1 && stops[0].t == 0)) {
        value = to_json(part, stops[0], false);
        return;
    }
    value = json::array();
    for (const ValueStop& stop : stops) value.push_back(to_json(part, stop, true));
}

void move_control_point(json& primitive, std::size_t point, const std::array<double, 3>& position, const std::string& name) {
    json& path = primitive["path"];
    const bool circle = path["type"] == "circle";
    const std::size_t count = circle ? 1 : path["points"].size();
    if (point >= count)
        throw usage(name + ": expected a point below " + std::to_string(count) + " (its path has " + counted(count, "point") +
                    "), found " + std::to_string(point));
    (circle ? path["center"] : path["points"][point]) = position;
}

void add_primitive(json& document, std::size_t layer, const std::string& primitive, std::optional<std::size_t> at) {
    if (layer >= document["layers"].size())
        throw usage("expected a layer below " + std::to_string(document["layers"].size()) + ", found " + std::to_string(layer));
    json& list = document["layers"][layer]["primitives"];
    const std::size_t place = at.value_or(list.size());
    if (place > list.size())
        throw usage("expected a place in the layer of at most " + std::to_string(list.size()) + ", found " +
                    std::to_string(place));
    list.insert(list.begin() + static_cast<std::ptrdiff_t>(place), parse_json_text(primitive, "the added primitive"));
}

void remove_primitive(json& document, const std::string& name, const std::string& file) {
    const auto [list, index] = place_of(document, name, file);
    list->erase(list->begin() + static_cast<std::ptrdiff_t>(index));
}

}  // namespace pvg
