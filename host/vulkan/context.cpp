#include "vulkan/context.h"

#include <algorithm>
#include <cstring>
#include <limits>

namespace pvg::vulkan {
namespace {

constexpr std::size_t staging_bytes = std::size_t(16) << 20;

}  // namespace

std::unique_ptr<Context> Context::create(const VulkanOptions& options) {
    std::unique_ptr<Context> context(new Context);
    context->instance_ = Instance::create(options.validation);
    if (!context->instance_) {
        throw Error(ErrorKind::device, "Vulkan: no usable device; no Vulkan loader or driver is installed");
    }
    const std::vector<Candidate> candidates = context->instance_->devices();
    const Candidate& chosen = candidates[pick_device(candidates, options.device)];
    context->info_ = chosen.info;

    const float priority = 1;
    auto queue = typed<VkDeviceQueueCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO);
    queue.queueFamilyIndex = chosen.queue_family;
    queue.queueCount = 1;
    queue.pQueuePriorities = &priority;
    auto create = typed<VkDeviceCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO);
    create.queueCreateInfoCount = 1;
    create.pQueueCreateInfos = &queue;
    const InstanceFunctions& functions = context->instance_->functions();
    Device& device = context->device_;
    VkDevice handle = VK_NULL_HANDLE;
    check(functions.CreateDevice(chosen.device, &create, nullptr, &handle), "creating a device");
    device.handle = handle;
    device.functions.load(functions.GetDeviceProcAddr, handle);
    device.limits = chosen.limits;
    functions.GetPhysicalDeviceMemoryProperties(chosen.device, &device.memory);
    const DeviceFunctions& vk = device.functions;
    vk.GetDeviceQueue(handle, chosen.queue_family, 0, &context->queue_);

    auto pool = typed<VkCommandPoolCreateInfo>(VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO);
    pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
    pool.queueFamilyIndex = chosen.queue_family;
    VkCommandPool raw_pool = VK_NULL_HANDLE;
    check(vk.CreateCommandPool(handle, &pool, nullptr, &raw_pool), "creating a command pool");
    context->pool_ = Owned<VkCommandPool>(handle, vk.DestroyCommandPool, raw_pool);
    auto fence = typed<VkFenceCreateInfo>(VK_STRUCTURE_TYPE_FENCE_CREATE_INFO);
    VkFence raw_fence = VK_NULL_HANDLE;
    check(vk.CreateFence(handle, &fence, nullptr, &raw_fence), "creating a fence");
    context->fence_ = Owned<VkFence>(handle, vk.DestroyFence, raw_fence);
    context->staging_ = Buffer(device, staging_bytes, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, Buffer::Memory::upload);
    context->copy_commands_ = context->make_command_buffer();
    context->check_messages("creating a device");
    return context;
}

Context::~Context() {
    if (!device_.handle || !device_.functions.DestroyDevice)
        return;
    if (device_.functions.DeviceWaitIdle)
        device_.functions.DeviceWaitIdle(device_.handle);
    staging_ = {};
    fence_ = {};
    pool_ = {};
    device_.functions.DestroyDevice(device_.handle, nullptr);
}

VkCommandBuffer Context::make_command_buffer() {
    auto allocate = typed<VkCommandBufferAllocateInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO);
    allocate.commandPool = pool_.get();
    allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    allocate.commandBufferCount = 1;
    VkCommandBuffer commands = VK_NULL_HANDLE;
    check(device_.functions.AllocateCommandBuffers(device_.handle, &allocate, &commands), "allocating a command buffer");
    return commands;
}

void Context::submit_and_wait(VkCommandBuffer commands) {
    const DeviceFunctions& vk = device_.functions;
    auto submit = typed<VkSubmitInfo>(VK_STRUCTURE_TYPE_SUBMIT_INFO);
    submit.commandBufferCount = 1;
    submit.pCommandBuffers = &commands;
    const VkFence fence = fence_.get();
    check(vk.QueueSubmit(queue_, 1, &submit, fence), "submitting work");
    check(vk.WaitForFences(device_.handle, 1, &fence, VK_TRUE, std::numeric_limits<std::uint64_t>::max()),
          "waiting for the device");
    check(vk.ResetFences(device_.handle, 1, &fence), "resetting a fence");
}

void Context::upload(const Buffer& target, const void* data, std::size_t bytes) {
    const DeviceFunctions& vk = device_.functions;
    const std::byte* source = static_cast<const std::byte*>(data);
    for (std::size_t done = 0; done < bytes;) {
        const std::size_t part = std::min(bytes - done, staging_bytes);
        std::memcpy(staging_.mapped(), source + done, part);
        staging_.flush(device_);
        auto begin = typed<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
        begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
        check(vk.BeginCommandBuffer(copy_commands_, &begin), "recording a copy");
        const VkBufferCopy region{0, done, part};
        vk.CmdCopyBuffer(copy_commands_, staging_.handle(), target.handle(), 1, &region);
        auto barrier = typed<VkMemoryBarrier>(VK_STRUCTURE_TYPE_MEMORY_BARRIER);
        barrier.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
        barrier.dstAccessMask = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_TRANSFER_WRITE_BIT;
        vk.CmdPipelineBarrier(copy_commands_, VK_PIPELINE_STAGE_TRANSFER_BIT,
                              VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 1, &barrier, 0, nullptr,
                              0, nullptr);
        check(vk.EndCommandBuffer(copy_commands_), "recording a copy");
        submit_and_wait(copy_commands_);
        done += part;
    }
}

}  // namespace pvg::vulkan
