// The compute pipelines of the kernels, made when first asked for.
#pragma once

#include <map>
#include <utility>

#include "vulkan/device.h"

namespace pvg::vulkan {

enum class Kernel { evaluate_1, evaluate_4, evaluate_5, displace, normals };

/// A kernel's pipeline. Inputs are texel buffers or storage buffers; the last binding is always a storage buffer.
struct Pipeline {
    std::uint32_t bindings = 0;
    std::uint32_t push_bytes = 0;
    bool texel = false;
    Owned<VkDescriptorSetLayout> set_layout;
    Owned<VkPipelineLayout> layout;
    Owned<VkPipeline> pipeline;
};

class Pipelines {
public:
    /// The Device must outlive the pipelines.
    explicit Pipelines(const Device& device) : device_(device) {}

    /// Stays where it is until this object goes. Throws Error(device).
    const Pipeline& get(Kernel kernel, bool texel);

private:
    const Device& device_;
    std::map<std::pair<Kernel, bool>, Pipeline> made_;
};

}  // namespace pvg::vulkan
