#include "vulkan/pipelines.h"

#include <span>
#include <vector>

#include "kernels/shared.h"
#include "vulkan/shaders/displace_storage.h"
#include "vulkan/shaders/displace_texel.h"
#include "vulkan/shaders/evaluate_1_storage.h"
#include "vulkan/shaders/evaluate_1_texel.h"
#include "vulkan/shaders/evaluate_4_storage.h"
#include "vulkan/shaders/evaluate_4_texel.h"
#include "vulkan/shaders/evaluate_5_storage.h"
#include "vulkan/shaders/evaluate_5_texel.h"
#include "vulkan/shaders/normals_storage.h"
#include "vulkan/shaders/normals_texel.h"

namespace pvg::vulkan {
namespace {

using Words = std::span<const std::uint32_t>;

Words shader_words(Kernel kernel, bool texel) {
    switch (kernel) {
        case Kernel::evaluate_1:
            return texel ? Words(evaluate_1_texel) : Words(evaluate_1_storage);
        case Kernel::evaluate_4:
            return texel ? Words(evaluate_4_texel) : Words(evaluate_4_storage);
        case Kernel::evaluate_5:
            return texel ? Words(evaluate_5_texel) : Words(evaluate_5_storage);
        case Kernel::displace:
            return texel ? Words(displace_texel) : Words(displace_storage);
        case Kernel::normals:
            break;
    }
    return texel ? Words(normals_texel) : Words(normals_storage);
}

}  // namespace

const Pipeline& Pipelines::get(Kernel kernel, bool texel) {
    const auto found = made_.find({kernel, texel});
    if (found != made_.end())
        return found->second;

    const DeviceFunctions& vk = device_.functions;
    const VkDevice device = device_.handle;
    Pipeline made;
    made.texel = texel;
    switch (kernel) {
        case Kernel::displace:
            made.bindings = PVG_DISPLACE_BINDINGS;
            made.push_bytes = sizeof(kernels::DisplaceRange);
            break;
        case Kernel::normals:
            made.bindings = PVG_NORMALS_BINDINGS;
            made.push_bytes = sizeof(kernels::NormalsRange);
            break;
        default:
            made.bindings = PVG_EVALUATE_BINDINGS;
            made.push_bytes = sizeof(kernels::EvaluateRange);
    }

    std::vector<VkDescriptorSetLayoutBinding> bindings(made.bindings);
    for (std::uint32_t i = 0; i < made.bindings; ++i) {
        bindings[i].binding = i;
        bindings[i].descriptorType =
            texel && i + 1 < made.bindings ? VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
        bindings[i].descriptorCount = 1;
        bindings[i].stageFlags = VK_SHADER_STAGE_COMPUTE_BIT;
    }
    auto set_layout = typed<VkDescriptorSetLayoutCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO);
    set_layout.bindingCount = made.bindings;
    set_layout.pBindings = bindings.data();
    VkDescriptorSetLayout raw_set_layout = VK_NULL_HANDLE;
    check(vk.CreateDescriptorSetLayout(device, &set_layout, nullptr, &raw_set_layout), "creating a descriptor set layout");
    made.set_layout = Owned<VkDescriptorSetLayout>(device, vk.DestroyDescriptorSetLayout, raw_set_layout);

    const VkPushConstantRange push{VK_SHADER_STAGE_COMPUTE_BIT, 0, made.push_bytes};
    auto layout = typed<VkPipelineLayoutCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO);
    layout.setLayoutCount = 1;
    layout.pSetLayouts = &raw_set_layout;
    layout.pushConstantRangeCount = 1;
    layout.pPushConstantRanges = &push;
    VkPipelineLayout raw_layout = VK_NULL_HANDLE;
    check(vk.CreatePipelineLayout(device, &layout, nullptr, &raw_layout), "creating a pipeline layout");
    made.layout = Owned<VkPipelineLayout>(device, vk.DestroyPipelineLayout, raw_layout);

    const Words words = shader_words(kernel, texel);
    auto module_info = typed<VkShaderModuleCreateInfo>(VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO);
    module_info.codeSize = words.size_bytes();
    module_info.pCode = words.data();
    VkShaderModule raw_module = VK_NULL_HANDLE;
    check(vk.CreateShaderModule(device, &module_info, nullptr, &raw_module), "creating a shader module");
    const Owned<VkShaderModule> shader(device, vk.DestroyShaderModule, raw_module);

    auto pipeline = typed<VkComputePipelineCreateInfo>(VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO);
    pipeline.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    pipeline.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
    pipeline.stage.module = raw_module;
    pipeline.stage.pName = "main";
    pipeline.layout = raw_layout;
    VkPipeline raw_pipeline = VK_NULL_HANDLE;
    check(vk.CreateComputePipelines(device, VK_NULL_HANDLE, 1, &pipeline, nullptr, &raw_pipeline), "creating a pipeline");
    made.pipeline = Owned<VkPipeline>(device, vk.DestroyPipeline, raw_pipeline);
    return made_.emplace(std::pair(kernel, texel), std::move(made)).first->second;
}

}  // namespace pvg::vulkan
