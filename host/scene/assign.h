// --set ID.KEY[.KEY...]=VALUE: edits of a scene's JSON before it is checked.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace pvg {

/// Sets one value in the primitive that has the ID. A key that is a number indexes an array (its size: appends); objects that are
/// missing on the way are made. VALUE is JSON, else a string. Throws Error(usage) when the assignment has no such form, no
/// primitive has the ID (the message lists those there are) or a key cannot be followed.
void apply_assignment(nlohmann::json& document, const std::string& assignment, const std::string& file);

}  // namespace pvg
