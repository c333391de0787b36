#include "app/device.h"

#include <chrono>

#include "cpu_reference/cpu_evaluator.h"
#ifdef PVG_HAS_VULKAN
#include "pvg/vulkan.h"
#endif

namespace pvg::app {
namespace {

class Stopwatch {
public:
    double lap() {
        const auto now = std::chrono::steady_clock::now();
        const double spent = std::chrono::duration<double>(now - started_).count();
        started_ = now;
        return spent;
    }

private:
    std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
};

DeviceResult on_cpu(const Program& program, int threads) {
    DeviceResult result;
    result.name = "CPU reference";
    result.type = "cpu";
    Stopwatch watch;
    result.evaluation = evaluate_on_cpu(program, threads);
    result.evaluate_seconds = watch.lap();
    return result;
}

}  // namespace

DeviceChoice parse_device(const std::string& text) {
    if (text == "auto")
        return {};
    if (text == "cpu")
        return {.kind = DeviceChoice::Kind::cpu, .name = {}};
    if (text == "vulkan")
        return {.kind = DeviceChoice::Kind::vulkan, .name = {}};
    if (text.starts_with("vulkan:") && text.size() > 7)
        return {.kind = DeviceChoice::Kind::vulkan, .name = text.substr(7)};
    throw Error(ErrorKind::usage, "--device: expected auto, vulkan, vulkan:NAME or cpu, found \"" + text + "\"");
}

std::optional<DeviceResult> evaluate_on_vulkan([[maybe_unused]] const Program& program,
                                               [[maybe_unused]] const DeviceChoice& choice, std::string& reason) {
#ifdef PVG_HAS_VULKAN
    Stopwatch watch;
    Result<VulkanEvaluator> evaluator = VulkanEvaluator::create({.device = choice.name, .validation = choice.validation});
    if (!evaluator) {
        reason = evaluator.error().what();
        return std::nullopt;
    }
    DeviceResult result;
    result.name = evaluator.value().device().name;
    result.type = evaluator.value().device().type;
    const Result<bool> loaded = evaluator.value().load(program);
    if (!loaded)
        throw Error(loaded.error());
    result.upload_seconds = watch.lap();
    Result<Evaluation> evaluation = evaluator.value().evaluate();
    if (!evaluation)
        throw Error(evaluation.error());
    result.evaluate_seconds = watch.lap();
    result.evaluation = std::move(evaluation.value());
    return result;
#else
    reason = "this pvg was built without Vulkan";
    return std::nullopt;
#endif
}

DeviceResult evaluate(const Program& program, const DeviceChoice& choice, int threads, Warnings& warnings) {
    if (choice.kind == DeviceChoice::Kind::cpu)
        return on_cpu(program, threads);
    std::string reason;
    if (std::optional<DeviceResult> result = evaluate_on_vulkan(program, choice, reason))
        return std::move(*result);
    if (choice.kind == DeviceChoice::Kind::vulkan)
        throw Error(ErrorKind::device, "--device: " + reason);
    warnings.push_back("no Vulkan device (" + reason + "); the CPU evaluates instead");
    return on_cpu(program, threads);
}

}  // namespace pvg::app
