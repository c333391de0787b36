// Joints and weights of a skinned primitive's output vertices.
#pragma once

#include "gltf/output_attributes.h"

namespace pvg::gltf {

/// How far the sum of a vertex's weights may be off 1, for each weight that is not 0: the Khronos validator's limit.
inline constexpr double weight_sum_tolerance = 2e-7;

/// JOINTS_n and WEIGHTS_n: a raw vertex keeps its own where they are valid; any other gets the blend of its corners' influences,
/// the largest four a set, renormalised. Throws Error(bad_input) for a negative weight or a joint that a skin does not have.
std::vector<OutputAttribute> influences(const RawPrimitive& primitive, const std::vector<OutputVertex>& vertices,
                                        std::size_t joint_count, const std::string& place, Warnings& warnings);

}  // namespace pvg::gltf
