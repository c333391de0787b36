// The JSON Schema of scene files (draft 7), carried inside the program.
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

namespace pvg {

/// The text of scenes/scene.schema.json.
const std::string& scene_schema();

/// Where and why a document does not fit the schema, "POINTER: reason", or nothing when it does. The schema sees shapes and
/// ranges only; parse_scene sees more (ascending stops, unique ids, counts of control points) and words its messages for people.
std::optional<std::string> schema_violation(const nlohmann::json& document);

}  // namespace pvg
