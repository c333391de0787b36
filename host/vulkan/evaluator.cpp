// The public face: exceptions of the parts become Results, and every call reports what the validation layers said.
#include <algorithm>
#include <cmath>
#include <new>
#include <optional>
#include <string>

#include "pvg/vulkan.h"
#include "vulkan/context.h"
#include "vulkan/runner.h"

namespace pvg {
namespace {

/// body(), with its exceptions turned into an Error.
template <typename T, typename Body>
Result<T> guarded(const Body& body) {
    try {
        return body();
    } catch (const Error& error) {
        return error;
    } catch (const std::bad_alloc&) {
        return Error(ErrorKind::device, "Vulkan: out of host memory");
    } catch (const std::exception& error) {
        return Error(ErrorKind::device, std::string("Vulkan: ") + error.what());
    }
}

}  // namespace

Result<std::vector<VulkanDeviceInfo>> list_vulkan_devices() {
    return guarded<std::vector<VulkanDeviceInfo>>([]() -> std::vector<VulkanDeviceInfo> {
        std::vector<VulkanDeviceInfo> infos;
        const auto instance = vulkan::Instance::create(false);
        if (!instance)
            return infos;
        for (const vulkan::Candidate& candidate : instance->devices()) infos.push_back(candidate.info);
        return infos;
    });
}

struct VulkanEvaluator::State {
    std::unique_ptr<vulkan::Context> context;
    std::optional<vulkan::Runner> runner;
    VkCommandBuffer commands = VK_NULL_HANDLE;
    bool loaded = false;

    vulkan::Runner::Upload upload() const {
        return
            [this](const vulkan::Buffer& target, const void* data, std::size_t bytes) { context->upload(target, data, bytes); };
    }
};

VulkanEvaluator::VulkanEvaluator() : state_(std::make_unique<State>()) {}
VulkanEvaluator::~VulkanEvaluator() = default;
VulkanEvaluator::VulkanEvaluator(VulkanEvaluator&&) noexcept = default;
VulkanEvaluator& VulkanEvaluator::operator=(VulkanEvaluator&&) noexcept = default;

Result<VulkanEvaluator> VulkanEvaluator::create(const VulkanOptions& options) {
    return guarded<VulkanEvaluator>([&] {
        VulkanEvaluator evaluator;
        State& state = *evaluator.state_;
        state.context = vulkan::Context::create(options);
        state.runner.emplace(state.context->device(), vulkan::RunnerOptions{});
        state.commands = state.context->make_command_buffer();
        return evaluator;
    });
}

const VulkanDeviceInfo& VulkanEvaluator::device() const { return state_->context->info(); }

Result<bool> VulkanEvaluator::load(const Program& program) {
    return guarded<bool>([&]() -> Result<bool> {
        State& state = *state_;
        if (Result<bool> valid = validate(program); !valid)
            return valid;
        state.loaded = false;
        state.runner->load(program, state.upload());
        auto begin = vulkan::typed<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
        const vulkan::DeviceFunctions& vk = state.context->device().functions;
        vulkan::check(vk.BeginCommandBuffer(state.commands, &begin), "recording");
        state.runner->record(state.commands);
        vulkan::check(vk.EndCommandBuffer(state.commands), "recording");
        state.context->check_messages("loading a program");
        state.loaded = true;
        return true;
    });
}

Result<bool> VulkanEvaluator::set_coefficients(std::size_t field, const std::vector<float>& coefficients) {
    return guarded<bool>([&]() -> Result<bool> {
        State& state = *state_;
        if (!state.loaded)
            return Error(ErrorKind::usage, "set_coefficients: no program is loaded");
        if (field >= state.runner->field_count()) {
            return Error(ErrorKind::usage, "set_coefficients: field " + std::to_string(field) + " of " +
                                               std::to_string(state.runner->field_count()));
        }
        if (coefficients.size() != state.runner->coefficient_size(field)) {
            return Error(ErrorKind::usage, "set_coefficients: field " + std::to_string(field) + " has " +
                                               std::to_string(state.runner->coefficient_size(field)) + " numbers, got " +
                                               std::to_string(coefficients.size()));
        }
        if (!std::all_of(coefficients.begin(), coefficients.end(), [](float x) { return std::isfinite(x); })) {
            return Error(ErrorKind::bad_input, "set_coefficients: every coefficient must be finite");
        }
        state.runner->set_coefficients(field, coefficients, state.upload());
        state.context->check_messages("uploading coefficients");
        return true;
    });
}

Result<Evaluation> VulkanEvaluator::evaluate() {
    return guarded<Evaluation>([&]() -> Result<Evaluation> {
        State& state = *state_;
        if (!state.loaded)
            return Error(ErrorKind::usage, "evaluate: no program is loaded");
        state.context->submit_and_wait(state.commands);
        state.context->check_messages("evaluating");
        return state.runner->read();
    });
}

}  // namespace pvg
