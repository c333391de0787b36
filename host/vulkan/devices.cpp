// Which devices there are, what they lack, and which one to take.
#include <algorithm>
#include <cctype>
#include <charconv>

#include "kernels/shared.h"
#include "vulkan/instance.h"

namespace pvg::vulkan {
namespace {

const char* type_name(VkPhysicalDeviceType type) {
    switch (type) {
        case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
            return "discrete";
        case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
            return "integrated";
        case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
            return "virtual";
        case VK_PHYSICAL_DEVICE_TYPE_CPU:
            return "cpu";
        default:
            return "other";
    }
}

/// Smaller is better.
int rank(const std::string& type) {
    const char* const order[] = {"discrete", "integrated", "virtual", "cpu"};
    return static_cast<int>(std::find(std::begin(order), std::end(order), type) - std::begin(order));
}

std::string version_text(std::uint32_t version) {
    return std::to_string(VK_API_VERSION_MAJOR(version)) + "." + std::to_string(VK_API_VERSION_MINOR(version)) + "." +
           std::to_string(VK_API_VERSION_PATCH(version));
}

/// What is wrong with a device, in words; empty when it can evaluate programs.
std::string shortcoming(const InstanceFunctions& functions, VkPhysicalDevice device, const VkPhysicalDeviceProperties& properties,
                        std::uint32_t& queue_family) {
    if (properties.apiVersion < VK_API_VERSION_1_1)
        return "it speaks Vulkan " + version_text(properties.apiVersion) + ", 1.1 is needed";
    std::uint32_t count = 0;
    functions.GetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    functions.GetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
    const auto family = std::find_if(families.begin(), families.end(), [](const VkQueueFamilyProperties& f) {
        return f.queueCount > 0 && (f.queueFlags & VK_QUEUE_COMPUTE_BIT);
    });
    if (family == families.end())
        return "it has no compute queue";
    queue_family = static_cast<std::uint32_t>(family - families.begin());

    const VkPhysicalDeviceLimits& limits = properties.limits;
    struct Need {
        const char* name;
        std::uint64_t has, needs;
    };
    const Need needs[] = {
        {"maxComputeWorkGroupInvocations", limits.maxComputeWorkGroupInvocations, PVG_LOCAL_SIZE},
        {"maxComputeWorkGroupSize[0]", limits.maxComputeWorkGroupSize[0], PVG_LOCAL_SIZE},
        {"maxComputeWorkGroupCount[0]", limits.maxComputeWorkGroupCount[0], 65535},
        {"maxStorageBufferRange", limits.maxStorageBufferRange, std::uint64_t(1) << 27},
        {"maxPerStageDescriptorStorageBuffers", limits.maxPerStageDescriptorStorageBuffers, PVG_EVALUATE_BINDINGS},
        {"maxPerStageDescriptorSampledImages", limits.maxPerStageDescriptorSampledImages, PVG_EVALUATE_BINDINGS},
        {"maxPushConstantsSize", limits.maxPushConstantsSize, sizeof(kernels::DisplaceRange)},
        {"maxTexelBufferElements", limits.maxTexelBufferElements, 65536},
    };
    for (const Need& need : needs) {
        if (need.has < need.needs) {
            return std::string(need.name) + " is " + std::to_string(need.has) + ", " + std::to_string(need.needs) + " is needed";
        }
    }
    const std::pair<VkFormat, const char*> formats[] = {{VK_FORMAT_R32_UINT, "R32_UINT"},
                                                        {VK_FORMAT_R32G32_UINT, "R32G32_UINT"},
                                                        {VK_FORMAT_R32G32B32A32_UINT, "R32G32B32A32_UINT"},
                                                        {VK_FORMAT_R32_SFLOAT, "R32_SFLOAT"},
                                                        {VK_FORMAT_R32G32B32A32_SFLOAT, "R32G32B32A32_SFLOAT"}};
    for (const auto& [format, name] : formats) {
        VkFormatProperties support{};
        functions.GetPhysicalDeviceFormatProperties(device, format, &support);
        if (!(support.bufferFeatures & VK_FORMAT_FEATURE_UNIFORM_TEXEL_BUFFER_BIT)) {
            return std::string("it has no texel buffers of format ") + name;
        }
    }
    return {};
}

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

std::string describe(const std::vector<Candidate>& candidates) {
    if (candidates.empty())
        return "no Vulkan device was found";
    std::string text = "found:";
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        const VulkanDeviceInfo& info = candidates[i].info;
        text += (i ? "; " : " ") + std::to_string(i) + " = \"" + info.name + "\" (" + info.type + ")";
        if (!info.usable)
            text += ", not usable: " + info.reason;
    }
    return text;
}

}  // namespace

std::vector<Candidate> Instance::devices() const {
    std::uint32_t count = 0;
    VkResult result = functions_.EnumeratePhysicalDevices(instance_, &count, nullptr);
    if (result == VK_ERROR_INITIALIZATION_FAILED)
        return {};  // a driver without any device
    check(result, "listing devices");
    std::vector<VkPhysicalDevice> handles(count);
    result = functions_.EnumeratePhysicalDevices(instance_, &count, handles.data());
    if (result == VK_ERROR_INITIALIZATION_FAILED)
        return {};
    check(result, "listing devices");
    handles.resize(count);

    std::vector<Candidate> candidates;
    for (VkPhysicalDevice device : handles) {
        VkPhysicalDeviceProperties properties{};
        functions_.GetPhysicalDeviceProperties(device, &properties);
        Candidate candidate;
        candidate.device = device;
        candidate.limits = properties.limits;
        VulkanDeviceInfo& info = candidate.info;
        info.name = properties.deviceName;
        info.type = type_name(properties.deviceType);
        info.driver = version_text(properties.driverVersion);
        info.api_major = VK_API_VERSION_MAJOR(properties.apiVersion);
        info.api_minor = VK_API_VERSION_MINOR(properties.apiVersion);
        info.api_patch = VK_API_VERSION_PATCH(properties.apiVersion);
        if (properties.apiVersion >= VK_API_VERSION_1_2) {
            auto driver = typed<VkPhysicalDeviceDriverProperties>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES);
            auto more = typed<VkPhysicalDeviceProperties2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2);
            more.pNext = &driver;
            functions_.GetPhysicalDeviceProperties2(device, &more);
            info.driver = std::string(driver.driverName) + (driver.driverInfo[0] ? " " : "") + driver.driverInfo;
        }
        info.reason = shortcoming(functions_, device, properties, candidate.queue_family);
        info.usable = info.reason.empty();
        candidates.push_back(std::move(candidate));
    }
    const auto best = std::min_element(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
        return std::pair(!a.info.usable, rank(a.info.type)) < std::pair(!b.info.usable, rank(b.info.type));
    });
    if (best != candidates.end())
        best->info.preferred = best->info.usable;
    return candidates;
}

std::size_t pick_device(const std::vector<Candidate>& candidates, const std::string& wanted) {
    const auto fail = [&](const std::string& what) -> Error {
        return Error(ErrorKind::device, "Vulkan: " + what + "; " + describe(candidates));
    };
    if (wanted.empty()) {
        const auto preferred =
            std::find_if(candidates.begin(), candidates.end(), [](const Candidate& c) { return c.info.preferred; });
        if (preferred == candidates.end())
            throw fail("no usable device");
        return static_cast<std::size_t>(preferred - candidates.begin());
    }
    std::vector<std::size_t> matches;
    std::size_t index = 0;
    const auto [end, error] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), index);
    if (error == std::errc() && end == wanted.data() + wanted.size() && index < candidates.size()) {
        matches.push_back(index);
    } else {
        for (std::size_t i = 0; i < candidates.size(); ++i) {
            if (lower(candidates[i].info.name).find(lower(wanted)) != std::string::npos)
                matches.push_back(i);
        }
    }
    if (matches.empty())
        throw fail("no device is called \"" + wanted + "\"");
    std::stable_sort(matches.begin(), matches.end(), [&](std::size_t a, std::size_t b) {
        return std::pair(!candidates[a].info.usable, rank(candidates[a].info.type)) <
               std::pair(!candidates[b].info.usable, rank(candidates[b].info.type));
    });
    if (!candidates[matches.front()].info.usable)
        throw fail("device \"" + wanted + "\" cannot be used");
    return matches.front();
}

}  // namespace pvg::vulkan
