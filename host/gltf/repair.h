// Errors of the input that are repaired in what is written, each with a warning.
#pragma once

#include "gltf/edition.h"

namespace pvg::gltf {

/// Accessors' min and max that do not hold, or are missing where glTF wants them (positions, times of animations).
void repair_bounds(const Document& document, Json& json, Warnings& warnings);
/// Scene nodes that are not roots: left out where an ancestor is in the scene already, else replaced by their root.
void repair_scenes(const Document& document, Json& json, Warnings& warnings);

/// Joint weights that do not sum to 1, in primitives that still have the input's accessors.
void repair_weights(const Document& document, Edition& edition, Warnings& warnings);

}  // namespace pvg::gltf
