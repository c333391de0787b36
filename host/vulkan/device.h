// A logical device as the evaluator needs it, and the objects that live on it. A Device owns nothing, so it can stand for
// the tool's own device or for somebody else's; every object made on it frees itself.
#pragma once

#include <cstddef>
#include <utility>

#include "vulkan/functions.h"

namespace pvg::vulkan {

struct Device {
    VkDevice handle = VK_NULL_HANDLE;
    DeviceFunctions functions;
    VkPhysicalDeviceLimits limits{};
    VkPhysicalDeviceMemoryProperties memory{};
};

/// A handle that is destroyed with its owner. The Device must outlive it.
template <typename Handle>
class Owned {
public:
    using Destroy = void(VKAPI_PTR*)(VkDevice, Handle, const VkAllocationCallbacks*);

    Owned() = default;
    Owned(VkDevice device, Destroy destroy, Handle handle) : device_(device), destroy_(destroy), handle_(handle) {}
    ~Owned() { reset(); }
    Owned(Owned&& other) noexcept { swap(other); }
    Owned& operator=(Owned&& other) noexcept {
        Owned taken(std::move(other));
        swap(taken);
        return *this;
    }

    Handle get() const { return handle_; }
    explicit operator bool() const { return handle_ != VK_NULL_HANDLE; }

private:
    void reset() {
        if (handle_ != VK_NULL_HANDLE)
            destroy_(device_, handle_, nullptr);
        handle_ = VK_NULL_HANDLE;
    }
    void swap(Owned& other) noexcept {
        std::swap(device_, other.device_);
        std::swap(destroy_, other.destroy_);
        std::swap(handle_, other.handle_);
    }

    VkDevice device_ = VK_NULL_HANDLE;
    Destroy destroy_ = nullptr;
    Handle handle_ = VK_NULL_HANDLE;
};

/// A buffer with its own memory. Host memory stays mapped.
class Buffer {
public:
    enum class Memory {
        device,    ///< on the device, copied to and from
        upload,    ///< written by the host
        readback,  ///< read by the host
    };

    Buffer() = default;
    /// bytes of 0 become a small buffer, since Vulkan has no empty ones. Throws Error(device).
    Buffer(const Device& device, VkDeviceSize bytes, VkBufferUsageFlags usage, Memory memory);

    VkBuffer handle() const { return buffer_.get(); }
    VkDeviceSize size() const { return size_; }
    std::byte* mapped() const { return mapped_; }
    /// Makes the host's writes visible to the device, and the device's to the host.
    void flush(const Device& device) const;
    void invalidate(const Device& device) const;

private:
    Owned<VkDeviceMemory> memory_;  // declared first: freed after the buffer
    Owned<VkBuffer> buffer_;
    VkDeviceSize size_ = 0;
    std::byte* mapped_ = nullptr;
    bool coherent_ = true;
};

/// A texel view of a part of a buffer.
Owned<VkBufferView> make_buffer_view(const Device& device, VkBuffer buffer, VkFormat format, VkDeviceSize offset,
                                     VkDeviceSize bytes);

}  // namespace pvg::vulkan
