// The tool's own device: instance, logical device, one compute queue, and copies to it through a staging buffer.
#pragma once

#include <memory>

#include "vulkan/device.h"
#include "vulkan/instance.h"

namespace pvg::vulkan {

class Context {
public:
    /// Throws Error(device) when there is no usable device; the message lists what was found.
    static std::unique_ptr<Context> create(const VulkanOptions& options);
    ~Context();
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;

    const Device& device() const { return device_; }
    const VulkanDeviceInfo& info() const { return info_; }

    /// Copies bytes to a device buffer and waits. The buffer may be read by compute shaders afterwards.
    void upload(const Buffer& target, const void* data, std::size_t bytes);
    /// A command buffer that can be submitted again and again.
    VkCommandBuffer make_command_buffer();
    void submit_and_wait(VkCommandBuffer commands);
    /// Throws Error(device) with the first message when the validation layers said anything since the last call.
    void check_messages(const char* during) const { instance_->check_messages(during); }

private:
    Context() = default;

    std::unique_ptr<Instance> instance_;
    VulkanDeviceInfo info_;
    Device device_;
    VkQueue queue_ = VK_NULL_HANDLE;
    Owned<VkCommandPool> pool_;
    Owned<VkFence> fence_;
    Buffer staging_;
    VkCommandBuffer copy_commands_ = VK_NULL_HANDLE;
};

}  // namespace pvg::vulkan
