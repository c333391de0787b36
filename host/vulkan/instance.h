// A Vulkan instance, with the messages of the validation layers where they are asked for, and the devices it shows.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "pvg/vulkan.h"
#include "vulkan/functions.h"

namespace pvg::vulkan {

/// Warnings and errors of the validation layers, collected from whatever thread reports them.
class Messages {
public:
    void add(std::string message);
    /// The messages since the last call.
    std::vector<std::string> take();

private:
    std::mutex mutex_;
    std::vector<std::string> messages_;
};

/// A physical device and what it is called.
struct Candidate {
    VkPhysicalDevice device = VK_NULL_HANDLE;
    std::uint32_t queue_family = 0;  ///< the compute family; only when info.usable
    VkPhysicalDeviceLimits limits{};
    VulkanDeviceInfo info;
};

class Instance {
public:
    /// Null when there is no loader or no driver: then there are no devices. Throws Error(device) on any other failure, and
    /// when validation is asked for and the layer is not installed.
    static std::unique_ptr<Instance> create(bool validation);
    ~Instance();
    Instance(const Instance&) = delete;
    Instance& operator=(const Instance&) = delete;

    /// The devices in the driver's order, checked against what the evaluator needs; the preferred one is marked.
    std::vector<Candidate> devices() const;
    const InstanceFunctions& functions() const { return functions_; }
    bool validation() const { return validation_; }
    /// Throws Error(device) with the first message when the validation layers said anything since the last call.
    void check_messages(const char* during) const;

private:
    Instance() = default;

    std::shared_ptr<const Loader> loader_;
    VkInstance instance_ = VK_NULL_HANDLE;
    VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
    InstanceFunctions functions_;
    bool validation_ = false;
    std::unique_ptr<Messages> messages_;
};

/// The position of the device that options.device asks for: empty takes the preferred one, else an index, else part of a
/// name (case ignored; of several the most preferable). Throws Error(device) that lists what was found.
std::size_t pick_device(const std::vector<Candidate>& candidates, const std::string& wanted);

}  // namespace pvg::vulkan
