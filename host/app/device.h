// Where a program is evaluated: the answer to --device.
#pragma once

#include <optional>
#include <string>

#include "pvg/program.h"
#include "pvg/status.h"

namespace pvg::app {

/// --device auto | vulkan | vulkan:NAME | cpu
struct DeviceChoice {
    enum class Kind { automatic, vulkan, cpu } kind = Kind::automatic;
    std::string name;         ///< part of a device's name, or its number; empty: the best
    bool validation = false;  ///< run with the validation layers; any message is an error
};

/// Throws Error(usage) for anything else.
DeviceChoice parse_device(const std::string& text);

struct DeviceResult {
    std::string name;
    std::string type;
    double upload_seconds = 0;
    double evaluate_seconds = 0;
    Evaluation evaluation;
};

/// Evaluates where the choice says. `automatic` without a Vulkan device uses the CPU and adds one warning; a device that is asked
/// for and missing, or that fails, is Error(device).
DeviceResult evaluate(const Program& program, const DeviceChoice& choice, int threads, Warnings& warnings);

/// The Vulkan result alone, or nothing (with the reason) where there is no device.
std::optional<DeviceResult> evaluate_on_vulkan(const Program& program, const DeviceChoice& choice, std::string& reason);

}  // namespace pvg::app
