#include "vulkan/device.h"

#include <algorithm>
#include <optional>
#include <string>

#include "pvg/status.h"

namespace pvg::vulkan {
namespace {

std::optional<std::uint32_t> memory_type(const Device& device, std::uint32_t allowed, VkMemoryPropertyFlags flags) {
    for (std::uint32_t i = 0; i < device.memory.memoryTypeCount; ++i) {
        if ((allowed >> i & 1u) && (device.memory.memoryTypes[i].propertyFlags & flags) == flags)
            return i;
    }
    return std::nullopt;
}

}  // namespace

Buffer::Buffer(const Device& device, VkDeviceSize bytes, VkBufferUsageFlags usage, Memory memory) {
    const DeviceFunctions& vk = device.functions;
    size_ = std::max<VkDeviceSize>(bytes, 16);
    auto create = typed<VkBufferCreateInfo>(VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO);
    create.size = size_;
    create.usage = usage;
    create.sharingMode = VK_SHARING_MODE_EXCLUSIVE;
    VkBuffer buffer = VK_NULL_HANDLE;
    check(vk.CreateBuffer(device.handle, &create, nullptr, &buffer), "creating a buffer");
    Owned<VkBuffer> owned_buffer(device.handle, vk.DestroyBuffer, buffer);

    VkMemoryRequirements needs{};
    vk.GetBufferMemoryRequirements(device.handle, buffer, &needs);
    constexpr VkMemoryPropertyFlags visible = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT;
    std::optional<std::uint32_t> type;
    if (memory == Memory::device) {
        type = memory_type(device, needs.memoryTypeBits, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
        if (!type)
            type = memory_type(device, needs.memoryTypeBits, 0);
    } else if (memory == Memory::upload) {
        type = memory_type(device, needs.memoryTypeBits, visible | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
    } else {
        // Uncached memory reads at a crawl over a bus.
        type = memory_type(device, needs.memoryTypeBits, visible | VK_MEMORY_PROPERTY_HOST_CACHED_BIT);
    }
    if (!type && memory != Memory::device)
        type = memory_type(device, needs.memoryTypeBits, visible);
    if (!type)
        throw Error(ErrorKind::device, "Vulkan: the device has no memory type for a buffer");

    auto allocate = typed<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
    allocate.allocationSize = needs.size;
    allocate.memoryTypeIndex = *type;
    VkDeviceMemory raw = VK_NULL_HANDLE;
    const VkResult result = vk.AllocateMemory(device.handle, &allocate, nullptr, &raw);
    if (result < 0) {
        throw Error(ErrorKind::device,
                    "Vulkan: allocating " + std::to_string(needs.size) + " bytes on the device: " + result_name(result));
    }
    memory_ = Owned<VkDeviceMemory>(device.handle, vk.FreeMemory, raw);
    buffer_ = std::move(owned_buffer);
    check(vk.BindBufferMemory(device.handle, buffer, raw, 0), "binding a buffer");
    if (memory != Memory::device) {
        void* data = nullptr;
        check(vk.MapMemory(device.handle, raw, 0, VK_WHOLE_SIZE, 0, &data), "mapping a buffer");
        mapped_ = static_cast<std::byte*>(data);
        coherent_ = device.memory.memoryTypes[*type].propertyFlags & VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    }
}

void Buffer::flush(const Device& device) const {
    if (coherent_)
        return;
    auto range = typed<VkMappedMemoryRange>(VK_STRUCTURE_TYPE_MAPPED_MEMORY_RANGE);
    range.memory = memory_.get();
    range.size = VK_WHOLE_SIZE;
    check(device.functions.FlushMappedMemoryRanges(device.handle, 1, &range), "flushing a buffer");
}

void Buffer::invalidate(const Device& device) const {
    if (coherent_)
        return;
    auto range = typed<VkMappedMemoryRange>(VK_STRUCTURE_TYPE_MAPPED_MEMORY_RANGE);
    range.memory = memory_.get();
    range.size = VK_WHOLE_SIZE;
    check(device.functions.InvalidateMappedMemoryRanges(device.handle, 1, &range), "reading a buffer back");
}

Owned<VkBufferView> make_buffer_view(const Device& device, VkBuffer buffer, VkFormat format, VkDeviceSize offset,
                                     VkDeviceSize bytes) {
    auto create = typed<VkBufferViewCreateInfo>(VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO);
    create.buffer = buffer;
    create.format = format;
    create.offset = offset;
    create.range = bytes;
    VkBufferView view = VK_NULL_HANDLE;
    check(device.functions.CreateBufferView(device.handle, &create, nullptr, &view), "creating a buffer view");
    return {device.handle, device.functions.DestroyBufferView, view};
}

}  // namespace pvg::vulkan
