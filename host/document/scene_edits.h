// Edits of a scene's JSON, as the calls of a SceneDocument make them. The document may hold anything afterwards: it is checked as
// a scene file is, when it is parsed.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "pvg/scene_document.h"

namespace pvg {

/// A primitive by id or JSON pointer. Throws Error(usage) naming those there are.
nlohmann::json& find_primitive(nlohmann::json& document, const std::string& name, const std::string& file);

/// The object that holds "color" and "height" of one stop. Throws Error(usage) when the primitive has no such part or stop.
nlohmann::json& find_stop(nlohmann::json& primitive, Part part, std::size_t stop, const std::string& name);

void replace_stops(nlohmann::json& primitive, Part part, const std::vector<ValueStop>& stops, const std::string& name);
void move_control_point(nlohmann::json& primitive, std::size_t point, const std::array<double, 3>& position,
                        const std::string& name);
void add_primitive(nlohmann::json& document, std::size_t layer, const std::string& primitive, std::optional<std::size_t> at);
void remove_primitive(nlohmann::json& document, const std::string& name, const std::string& file);

/// A colour of that part as the scene writes it.
nlohmann::json written_color(Part part, const std::array<double, 4>& color);

}  // namespace pvg
