// The Vulkan evaluator and the device it runs on.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pvg/program.h"
#include "pvg/status.h"

namespace pvg {

/// What `pvg devices` prints.
struct VulkanDeviceInfo {
    std::string name;
    std::string type;    ///< "discrete", "integrated", "virtual", "cpu", "other"
    std::string driver;  ///< driver name and version
    std::uint32_t api_major = 0, api_minor = 0, api_patch = 0;
    bool usable = false;
    std::string reason;      ///< why not, when not usable
    bool preferred = false;  ///< what `auto` takes
};

/// All Vulkan devices; empty when there is no driver. Never fails for want of a device.
Result<std::vector<VulkanDeviceInfo>> list_vulkan_devices();

struct VulkanOptions {
    std::string device;       ///< empty: the best one (discrete, integrated, virtual, cpu); else part of a name, or an index
    bool validation = false;  ///< core and synchronization validation; any message becomes an error of the call that caused it
};

/// A device with everything that evaluating programs needs. Not thread-safe; buffers stay on the device between calls.
class VulkanEvaluator {
public:
    /// Error(device) when there is no usable device: the message lists what was found.
    static Result<VulkanEvaluator> create(const VulkanOptions& options);
    ~VulkanEvaluator();
    VulkanEvaluator(VulkanEvaluator&&) noexcept;
    VulkanEvaluator& operator=(VulkanEvaluator&&) noexcept;

    const VulkanDeviceInfo& device() const;
    /// Uploads tables and geometry; replaces what was loaded before. Validates first.
    Result<bool> load(const Program& program);
    /// New coefficients of one field (same size); only they are uploaded.
    Result<bool> set_coefficients(std::size_t field, const std::vector<float>& coefficients);
    /// Runs evaluate, displace and normals, and reads everything back.
    Result<Evaluation> evaluate();

private:
    VulkanEvaluator();
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace pvg
