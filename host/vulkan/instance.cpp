#include "vulkan/instance.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace pvg::vulkan {
namespace {

constexpr const char* validation_layer = "VK_LAYER_KHRONOS_validation";

VKAPI_ATTR VkBool32 VKAPI_CALL receive(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                       const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
    // An exception may not pass through the driver: a message that cannot be kept is the only one lost.
    try {
        static_cast<Messages*>(user)->add(data->pMessage ? data->pMessage : "(no text)");
    } catch (...) {
    }
    return VK_FALSE;
}

bool has_layer(const Loader& loader, const char* name) {
    std::uint32_t count = 0;
    check(loader.EnumerateInstanceLayerProperties(&count, nullptr), "listing layers");
    std::vector<VkLayerProperties> layers(count);
    check(loader.EnumerateInstanceLayerProperties(&count, layers.data()), "listing layers");
    return std::any_of(layers.begin(), layers.begin() + count,
                       [&](const VkLayerProperties& layer) { return std::strcmp(layer.layerName, name) == 0; });
}

}  // namespace

void Messages::add(std::string message) {
    const std::lock_guard lock(mutex_);
    messages_.push_back(std::move(message));
}

std::vector<std::string> Messages::take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(messages_, {});
}

std::unique_ptr<Instance> Instance::create(bool validation) {
    std::unique_ptr<Instance> instance(new Instance);
    instance->loader_ = Loader::open();
    if (!instance->loader_)
        return nullptr;
    const Loader& loader = *instance->loader_;
    instance->validation_ = validation;
    instance->messages_ = std::make_unique<Messages>();

    std::uint32_t version = VK_API_VERSION_1_0;
    if (loader.EnumerateInstanceVersion)
        check(loader.EnumerateInstanceVersion(&version), "asking the loader's version");
    if (version < VK_API_VERSION_1_1) {
        throw Error(ErrorKind::device, "Vulkan: the loader speaks Vulkan 1.0, 1.1 or later is needed");
    }
    auto application = typed<VkApplicationInfo>(VK_STRUCTURE_TYPE_APPLICATION_INFO);
    application.pApplicationName = "pvg";
    application.apiVersion = std::min<std::uint32_t>(version, VK_API_VERSION_1_3);

    auto create = typed<VkInstanceCreateInfo>(VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO);
    create.pApplicationInfo = &application;
    const char* extensions[] = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME};
    const std::array<VkValidationFeatureEnableEXT, 1> enabled{VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
    auto messenger = typed<VkDebugUtilsMessengerCreateInfoEXT>(VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT);
    messenger.messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
    messenger.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
    messenger.pfnUserCallback = receive;
    messenger.pUserData = instance->messages_.get();
    auto features = typed<VkValidationFeaturesEXT>(VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT);
    features.pNext = &messenger;
    features.enabledValidationFeatureCount = static_cast<std::uint32_t>(enabled.size());
    features.pEnabledValidationFeatures = enabled.data();
    if (validation) {
        if (!has_layer(loader, validation_layer)) {
            throw Error(ErrorKind::device, std::string("Vulkan: validation needs the layer ") + validation_layer +
                                               " (Debian package vulkan-validationlayers), which is not installed");
        }
        create.pNext = &features;
        create.enabledLayerCount = 1;
        create.ppEnabledLayerNames = &validation_layer;
        create.enabledExtensionCount = 1;
        create.ppEnabledExtensionNames = extensions;
    }
    const VkResult result = loader.CreateInstance(&create, nullptr, &instance->instance_);
    if (result == VK_ERROR_INCOMPATIBLE_DRIVER)
        return nullptr;  // a loader without any driver
    check(result, "creating an instance");
    instance->functions_.load(loader.GetInstanceProcAddr, instance->instance_);
    if (validation) {
        if (!instance->functions_.CreateDebugUtilsMessengerEXT || !instance->functions_.DestroyDebugUtilsMessengerEXT) {
            throw Error(ErrorKind::device, "Vulkan: validation needs VK_EXT_debug_utils, which the loader lacks");
        }
        check(instance->functions_.CreateDebugUtilsMessengerEXT(instance->instance_, &messenger, nullptr, &instance->messenger_),
              "creating a debug messenger");
    }
    return instance;
}

Instance::~Instance() {
    if (!instance_ || !functions_.DestroyInstance)
        return;
    if (messenger_)
        functions_.DestroyDebugUtilsMessengerEXT(instance_, messenger_, nullptr);
    functions_.DestroyInstance(instance_, nullptr);
}

void Instance::check_messages(const char* during) const {
    const std::vector<std::string> messages = messages_->take();
    if (messages.empty())
        return;
    throw Error(ErrorKind::device, "Vulkan: " + std::to_string(messages.size()) + " validation message(s) while " + during +
                                       ", the first: " + messages.front());
}

}  // namespace pvg::vulkan
