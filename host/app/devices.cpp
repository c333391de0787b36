// pvg devices: what Vulkan offers on this machine.
#include <cstdio>

#include <nlohmann/json.hpp>

#include "app/verbs.h"
#ifdef PVG_HAS_VULKAN
#include "pvg/vulkan.h"
#endif

namespace pvg::app {

int devices(const DevicesOptions& options, Console& console) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
#ifdef PVG_HAS_VULKAN
    const auto found = list_vulkan_devices();
    if (!found)
        throw Error(found.error());
    for (const VulkanDeviceInfo& device : found.value())
        list.push_back({{"name", device.name},
                        {"type", device.type},
                        {"driver", device.driver},
                        {"api", std::to_string(device.api_major) + "." + std::to_string(device.api_minor) + "." +
                                    std::to_string(device.api_patch)},
                        {"usable", device.usable},
                        {"reason", device.reason},
                        {"auto", device.preferred}});
#endif
    if (options.json) {
        std::printf("%s\n", nlohmann::ordered_json{{"devices", list}}.dump(2).c_str());
        return 0;
    }
    if (list.empty()) {
        console.say("no Vulkan device; `--device auto` takes the CPU");
        return 0;
    }
    std::printf("%-5s %-10s %-8s %-8s %s\n", "", "type", "api", "usable", "name (driver)");
    int number = 0;
    for (const auto& device : list) {
        std::printf("%-5s %-10s %-8s %-8s %d: %s (%s)%s%s\n", device["auto"].get<bool>() ? "auto" : "",
                    device["type"].get<std::string>().c_str(), device["api"].get<std::string>().c_str(),
                    device["usable"].get<bool>() ? "yes" : "no", number++, device["name"].get<std::string>().c_str(),
                    device["driver"].get<std::string>().c_str(), device["usable"].get<bool>() ? "" : ": ",
                    device["reason"].get<std::string>().c_str());
    }
    return 0;
}

}  // namespace pvg::app
