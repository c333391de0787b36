#include "vulkan/functions.h"

#include <dlfcn.h>

#include <string>

#include "pvg/status.h"

namespace pvg::vulkan {
namespace {

template <typename Function>
Function found(PFN_vkVoidFunction function, const char* name) {
    if (!function)
        throw Error(ErrorKind::device, std::string("Vulkan: the driver has no function ") + name);
    return reinterpret_cast<Function>(function);
}

}  // namespace

std::shared_ptr<const Loader> Loader::open() {
    std::shared_ptr<Loader> loader(new Loader);
    for (const char* name : {"libvulkan.so.1", "libvulkan.so"}) {
        loader->library_ = dlopen(name, RTLD_NOW | RTLD_LOCAL);
        if (loader->library_)
            break;
    }
    if (!loader->library_)
        return nullptr;
    loader->GetInstanceProcAddr = reinterpret_cast<PFN_vkGetInstanceProcAddr>(dlsym(loader->library_, "vkGetInstanceProcAddr"));
    if (!loader->GetInstanceProcAddr)
        return nullptr;
    const auto get = [&](const char* name) { return loader->GetInstanceProcAddr(nullptr, name); };
    loader->EnumerateInstanceVersion = reinterpret_cast<PFN_vkEnumerateInstanceVersion>(get("vkEnumerateInstanceVersion"));
#define PVG_VULKAN_LOAD(name)                                       \
    loader->name = reinterpret_cast<PFN_vk##name>(get("vk" #name)); \
    if (!loader->name)                                              \
        return nullptr;
    PVG_VULKAN_GLOBAL_FUNCTIONS(PVG_VULKAN_LOAD)
#undef PVG_VULKAN_LOAD
    return loader;
}

Loader::~Loader() {
    if (library_)
        dlclose(library_);
}

void InstanceFunctions::load(PFN_vkGetInstanceProcAddr get, VkInstance instance) {
#define PVG_VULKAN_LOAD(name) name = found<PFN_vk##name>(get(instance, "vk" #name), "vk" #name);
    PVG_VULKAN_INSTANCE_FUNCTIONS(PVG_VULKAN_LOAD)
#undef PVG_VULKAN_LOAD
    CreateDebugUtilsMessengerEXT =
        reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(get(instance, "vkCreateDebugUtilsMessengerEXT"));
    DestroyDebugUtilsMessengerEXT =
        reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(get(instance, "vkDestroyDebugUtilsMessengerEXT"));
}

void DeviceFunctions::load(PFN_vkGetDeviceProcAddr get, VkDevice device) {
#define PVG_VULKAN_LOAD(name) name = found<PFN_vk##name>(get(device, "vk" #name), "vk" #name);
    PVG_VULKAN_DEVICE_FUNCTIONS(PVG_VULKAN_LOAD)
#undef PVG_VULKAN_LOAD
}

const char* result_name(VkResult result) {
    switch (result) {
#define PVG_VULKAN_NAME(code) \
    case code:                \
        return #code;
        PVG_VULKAN_NAME(VK_SUCCESS)
        PVG_VULKAN_NAME(VK_NOT_READY)
        PVG_VULKAN_NAME(VK_TIMEOUT)
        PVG_VULKAN_NAME(VK_INCOMPLETE)
        PVG_VULKAN_NAME(VK_ERROR_OUT_OF_HOST_MEMORY)
        PVG_VULKAN_NAME(VK_ERROR_OUT_OF_DEVICE_MEMORY)
        PVG_VULKAN_NAME(VK_ERROR_INITIALIZATION_FAILED)
        PVG_VULKAN_NAME(VK_ERROR_DEVICE_LOST)
        PVG_VULKAN_NAME(VK_ERROR_MEMORY_MAP_FAILED)
        PVG_VULKAN_NAME(VK_ERROR_LAYER_NOT_PRESENT)
        PVG_VULKAN_NAME(VK_ERROR_EXTENSION_NOT_PRESENT)
        PVG_VULKAN_NAME(VK_ERROR_FEATURE_NOT_PRESENT)
        PVG_VULKAN_NAME(VK_ERROR_INCOMPATIBLE_DRIVER)
        PVG_VULKAN_NAME(VK_ERROR_TOO_MANY_OBJECTS)
        PVG_VULKAN_NAME(VK_ERROR_FORMAT_NOT_SUPPORTED)
        PVG_VULKAN_NAME(VK_ERROR_FRAGMENTED_POOL)
        PVG_VULKAN_NAME(VK_ERROR_OUT_OF_POOL_MEMORY)
        PVG_VULKAN_NAME(VK_ERROR_FRAGMENTATION)
        PVG_VULKAN_NAME(VK_ERROR_UNKNOWN)
#undef PVG_VULKAN_NAME
        default:
            return "an unnamed Vulkan error";
    }
}

void check(VkResult result, const char* what) {
    if (result < 0)
        throw Error(ErrorKind::device, std::string("Vulkan: ") + what + ": " + result_name(result));
}

}  // namespace pvg::vulkan
