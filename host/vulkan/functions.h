// The Vulkan functions in use, as tables: one for the loader, one per instance, one per device. Nothing is linked and
// nothing is global, so the library starts without libvulkan, and several devices or an embedder's own loader do not disturb each
// other.
#pragma once

#ifndef VK_NO_PROTOTYPES
#define VK_NO_PROTOTYPES
#endif
#include <vulkan/vulkan.h>

#include <memory>

namespace pvg::vulkan {

#define PVG_VULKAN_GLOBAL_FUNCTIONS(X) \
    X(CreateInstance)                  \
    X(EnumerateInstanceLayerProperties)

#define PVG_VULKAN_INSTANCE_FUNCTIONS(X)      \
    X(DestroyInstance)                        \
    X(EnumeratePhysicalDevices)               \
    X(GetPhysicalDeviceProperties)            \
    X(GetPhysicalDeviceProperties2)           \
    X(GetPhysicalDeviceMemoryProperties)      \
    X(GetPhysicalDeviceQueueFamilyProperties) \
    X(GetPhysicalDeviceFormatProperties)      \
    X(CreateDevice)                           \
    X(GetDeviceProcAddr)

#define PVG_VULKAN_DEVICE_FUNCTIONS(X) \
    X(DestroyDevice)                   \
    X(GetDeviceQueue)                  \
    X(DeviceWaitIdle)                  \
    X(CreateBuffer)                    \
    X(DestroyBuffer)                   \
    X(GetBufferMemoryRequirements)     \
    X(AllocateMemory)                  \
    X(FreeMemory)                      \
    X(BindBufferMemory)                \
    X(MapMemory)                       \
    X(InvalidateMappedMemoryRanges)    \
    X(FlushMappedMemoryRanges)         \
    X(CreateBufferView)                \
    X(DestroyBufferView)               \
    X(CreateShaderModule)              \
    X(DestroyShaderModule)             \
    X(CreateDescriptorSetLayout)       \
    X(DestroyDescriptorSetLayout)      \
    X(CreatePipelineLayout)            \
    X(DestroyPipelineLayout)           \
    X(CreateComputePipelines)          \
    X(DestroyPipeline)                 \
    X(CreateDescriptorPool)            \
    X(DestroyDescriptorPool)           \
    X(AllocateDescriptorSets)          \
    X(UpdateDescriptorSets)            \
    X(CreateCommandPool)               \
    X(DestroyCommandPool)              \
    X(AllocateCommandBuffers)          \
    X(BeginCommandBuffer)              \
    X(EndCommandBuffer)                \
    X(CmdBindPipeline)                 \
    X(CmdBindDescriptorSets)           \
    X(CmdPushConstants)                \
    X(CmdDispatch)                     \
    X(CmdPipelineBarrier)              \
    X(CmdCopyBuffer)                   \
    X(QueueSubmit)                     \
    X(CreateFence)                     \
    X(DestroyFence)                    \
    X(ResetFences)                     \
    X(WaitForFences)

#define PVG_VULKAN_MEMBER(name) PFN_vk##name name = nullptr;

/// The system's loader (libvulkan.so.1), kept open as long as this object lives.
class Loader {
public:
    /// Null when the machine has no Vulkan loader, or one without vkCreateInstance.
    static std::shared_ptr<const Loader> open();
    ~Loader();
    Loader(const Loader&) = delete;
    Loader& operator=(const Loader&) = delete;

    PFN_vkGetInstanceProcAddr GetInstanceProcAddr = nullptr;
    PFN_vkEnumerateInstanceVersion EnumerateInstanceVersion = nullptr;  ///< null with a Vulkan 1.0 loader
    PVG_VULKAN_GLOBAL_FUNCTIONS(PVG_VULKAN_MEMBER)

private:
    Loader() = default;
    void* library_ = nullptr;
};

struct InstanceFunctions {
    PVG_VULKAN_INSTANCE_FUNCTIONS(PVG_VULKAN_MEMBER)
    PFN_vkCreateDebugUtilsMessengerEXT CreateDebugUtilsMessengerEXT = nullptr;    ///< null without VK_EXT_debug_utils
    PFN_vkDestroyDebugUtilsMessengerEXT DestroyDebugUtilsMessengerEXT = nullptr;  ///< null without VK_EXT_debug_utils

    /// Throws Error(device) naming a function that is missing.
    void load(PFN_vkGetInstanceProcAddr get, VkInstance instance);
};

struct DeviceFunctions {
    PVG_VULKAN_DEVICE_FUNCTIONS(PVG_VULKAN_MEMBER)

    /// Throws Error(device) naming a function that is missing.
    void load(PFN_vkGetDeviceProcAddr get, VkDevice device);
};

#undef PVG_VULKAN_MEMBER

/// A Vulkan structure with its type set and everything else zero.
template <typename Structure>
Structure typed(VkStructureType type) {
    Structure structure{};
    structure.sType = type;
    return structure;
}

/// The name of a result code, such as "VK_ERROR_DEVICE_LOST".
const char* result_name(VkResult result);
/// Throws Error(device) "what: VK_ERROR_..." when result is an error (negative).
void check(VkResult result, const char* what);

}  // namespace pvg::vulkan
