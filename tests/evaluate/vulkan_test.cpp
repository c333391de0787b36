// The Vulkan evaluator against its CPU twin, with the validation layers on.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <functional>

#include "cpu_reference/agreement.h"
#include "cpu_reference/cpu_evaluator.h"
#include "evaluate/bits.h"
#include "evaluate/random_program.h"
#include "pvg/vulkan.h"
#include "vulkan/context.h"
#include "vulkan/runner.h"

namespace pvg {
namespace {

using test::random_program;
using vulkan::Context;
using vulkan::Runner;
using vulkan::RunnerOptions;

bool no_device() {
    const auto devices = list_vulkan_devices();
    return !devices || std::none_of(devices.value().begin(), devices.value().end(), [](const auto& d) { return d.usable; });
}

#define SKIP_WITHOUT_DEVICE() \
    if (no_device())          \
    GTEST_SKIP() << "no usable Vulkan device"

/// A runner on the preferred device with limits of its own. Throws what the parts throw.
class Machine {
public:
    explicit Machine(const RunnerOptions& options, bool validation = true)
        : context_(Context::create({"", validation})),
          runner_(context_->device(), options),
          commands_(context_->make_command_buffer()) {}

    void load(const Program& program) {
        runner_.load(program, upload());
        auto begin = vulkan::typed<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
        vulkan::check(context_->device().functions.BeginCommandBuffer(commands_, &begin), "begin");
        runner_.record(commands_);
        vulkan::check(context_->device().functions.EndCommandBuffer(commands_), "end");
        context_->check_messages("loading");
    }
    void run() {
        context_->submit_and_wait(commands_);
        context_->check_messages("running");
    }
    Evaluation evaluate() {
        run();
        return runner_.read();
    }
    Runner& runner() { return runner_; }
    Context& context() { return *context_; }
    Runner::Upload upload() {
        return
            [this](const vulkan::Buffer& target, const void* data, std::size_t bytes) { context_->upload(target, data, bytes); };
    }

private:
    std::unique_ptr<Context> context_;
    Runner runner_;
    VkCommandBuffer commands_;
};

/// Bit for bit on lavapipe, within the stated bound elsewhere.

void expect_agreement(const std::string& device_type, const Program& program, const Evaluation& cpu, const Evaluation& gpu) {
    if (device_type == "cpu") {
        EXPECT_EQ(test::first_difference(cpu, gpu), "");
    } else {
        EXPECT_EQ(first_beyond_bound(program, gpu), "");
    }
}

void expect_twins(Machine& machine, const Program& program) {
    machine.load(program);
    expect_agreement(machine.context().info().type, program, evaluate_on_cpu(program), machine.evaluate());
}

TEST(VulkanEvaluator, AgreesWithTheCpu) {
    SKIP_WITHOUT_DEVICE();
    Machine machine({});
    for (std::uint32_t rows : {0u, 1u, 63u, 64u, 65u, 777u, 20'000u}) {
        SCOPED_TRACE(rows);
        expect_twins(machine, random_program(rows + 1, rows, rows ? 5 + rows / 16 : 0));
        EXPECT_EQ(machine.runner().texel_dispatch_count(), machine.runner().dispatch_count());
    }
}

TEST(VulkanEvaluator, AgreesOnLargeTables) {
    SKIP_WITHOUT_DEVICE();
    Machine machine({});
    expect_twins(machine, random_program(11, 100'000, 6250));
}

TEST(VulkanEvaluator, HeightTermsInAnyOrderOfFields) {
    SKIP_WITHOUT_DEVICE();
    Machine machine({});
    expect_twins(machine, random_program(12, 900, 60, false));
}

TEST(VulkanEvaluator, SurfaceWithoutFieldsOrTerms) {
    SKIP_WITHOUT_DEVICE();
    Machine machine({});
    Program program;
    std::mt19937 random(13);
    test::add_surface(random, program, 9, 2, true);
    expect_twins(machine, program);
    const Program empty = [] {
        Program none;
        none.height_first = none.corner_first = {0};
        return none;
    }();
    expect_twins(machine, empty);
}

TEST(VulkanEvaluator, StorageBuffersAgreeToo) {
    SKIP_WITHOUT_DEVICE();
    RunnerOptions options;
    options.storage_only = true;
    Machine machine(options);
    expect_twins(machine, random_program(14, 3000, 100, false));
    EXPECT_EQ(machine.runner().texel_dispatch_count(), 0u);
}

TEST(VulkanEvaluator, SmallLimitsCutDispatches) {
    SKIP_WITHOUT_DEVICE();
    const Program program = random_program(15, 5000, 200);
    const auto dispatches = [&](const RunnerOptions& options, bool texel) {
        Machine machine(options);
        expect_twins(machine, program);
        EXPECT_EQ(machine.runner().texel_dispatch_count() > 0, texel);
        return machine.runner().dispatch_count();
    };
    const std::size_t whole = dispatches({}, true);
    RunnerOptions groups;
    groups.max_workgroups = 3;
    EXPECT_GT(dispatches(groups, true), whole + 40);
    RunnerOptions texels;
    texels.max_texels = 26'000;  // holds the 25,000 values of the largest field, not its weights
    EXPECT_GT(dispatches(texels, true), whole);
    RunnerOptions bytes;
    bytes.max_storage_bytes = 128'000;
    EXPECT_GT(dispatches(bytes, true), whole);
    // Coefficients and positions that no texel buffer holds: storage buffers take over.
    RunnerOptions none;
    none.max_texels = 100;
    EXPECT_GE(dispatches(none, false), whole);
}

TEST(VulkanEvaluator, WhatDoesNotFitIsAnErrorOfTheDevice) {
    SKIP_WITHOUT_DEVICE();
    RunnerOptions options;
    options.max_storage_bytes = 2048;
    options.storage_only = true;
    Machine machine(options);
    try {
        machine.load(random_program(16, 3000, 10));
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::device);
        EXPECT_NE(std::string(error.what()).find("2048"), std::string::npos) << error.what();
    }
    EXPECT_EQ(machine.runner().field_count(), 0u);
}

TEST(VulkanEvaluator, SubnormalsStayWithinTheBound) {
    SKIP_WITHOUT_DEVICE();
    Machine machine({});
    Program program = random_program(17, 500, 10);
    for (Field& field : program.fields) {
        for (float& x : field.coefficients) x *= 1e-38f;
    }
    machine.load(program);
    EXPECT_EQ(first_beyond_bound(program, machine.evaluate()), "");
}

TEST(VulkanEvaluator, NewCoefficientsReplaceTheOld) {
    SKIP_WITHOUT_DEVICE();
    auto made = VulkanEvaluator::create({"", true});
    ASSERT_TRUE(made) << made.error().what();
    VulkanEvaluator evaluator = std::move(made.value());
    EXPECT_EQ(evaluator.evaluate().error().kind(), ErrorKind::usage);
    Program program = random_program(18, 2000, 80);
    const auto loaded = evaluator.load(program);
    ASSERT_TRUE(loaded) << loaded.error().what();
    for (int round = 0; round < 3; ++round) {
        for (std::size_t f = 0; f < program.fields.size(); ++f) {
            if (round == 1 && f == 1)
                continue;  // a field that keeps its coefficients
            for (float& x : program.fields[f].coefficients) x = -0.7f * x + 0.1f;
            const auto set = evaluator.set_coefficients(f, program.fields[f].coefficients);
            ASSERT_TRUE(set) << set.error().what();
        }
        const auto gpu = evaluator.evaluate();
        ASSERT_TRUE(gpu) << gpu.error().what();
        expect_agreement(evaluator.device().type, program, evaluate_on_cpu(program), gpu.value());
        const auto again = evaluator.evaluate();
        ASSERT_TRUE(again) << again.error().what();
        EXPECT_EQ(test::first_difference(gpu.value(), again.value()), "");
    }
    EXPECT_EQ(evaluator.set_coefficients(99, {}).error().kind(), ErrorKind::usage);
    EXPECT_EQ(evaluator.set_coefficients(0, {1, 2, 3}).error().kind(), ErrorKind::usage);
    std::vector<float> bad = program.fields[0].coefficients;
    bad[0] = NAN;
    EXPECT_EQ(evaluator.set_coefficients(0, bad).error().kind(), ErrorKind::bad_input);

    // A program that is not valid is refused and leaves what was loaded.
    Program broken = program;
    broken.corners[0][0] = 1u << 30;
    EXPECT_EQ(evaluator.load(broken).error().kind(), ErrorKind::bad_input);
    const auto still = evaluator.evaluate();
    ASSERT_TRUE(still);
    expect_agreement(evaluator.device().type, program, evaluate_on_cpu(program), still.value());
}

TEST(VulkanEvaluator, WrongUseIsSeenByTheValidationLayers) {
    SKIP_WITHOUT_DEVICE();
    Machine machine({});
    auto buffer =
        vulkan::Buffer(machine.context().device(), 64, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, vulkan::Buffer::Memory::device);
    const std::vector<char> bytes(64);
    machine.context().upload(buffer, bytes.data(), bytes.size());  // not a transfer destination
    EXPECT_THROW(machine.context().check_messages("misusing a buffer"), Error);
}

/// Medians of nine runs: time on the clock, and the process's time on all cores, which other work on the machine
/// disturbs less and in which a software device counts too.
std::string timed(const std::function<void()>& work) {
    std::vector<double> wall, cores;
    for (int i = 0; i < 9; ++i) {
        const auto start = std::chrono::steady_clock::now();
        const std::clock_t cores_start = std::clock();
        work();
        wall.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
        cores.push_back(1e3 * static_cast<double>(std::clock() - cores_start) / CLOCKS_PER_SEC);
    }
    std::sort(wall.begin(), wall.end());
    std::sort(cores.begin(), cores.end());
    char text[64];
    std::snprintf(text, sizeof(text), "%.1f ms, %.1f ms of cores", wall[4], cores[4]);
    return text;
}

// Prints; asserts only that what is timed is right.
TEST(VulkanTiming, OneHundredThousandRows) {
    SKIP_WITHOUT_DEVICE();
    for (std::uint32_t channels : {1u, 4u, 5u}) {
        std::mt19937 random(19);
        Program program;
        program.height_first = program.corner_first = {0};
        program.fields.push_back(test::random_field(random, 100'000, 12'000, channels, -24));
        const std::string what = "100k rows x 24 entries x " + std::to_string(channels) + " channels, ";
        for (bool storage : {false, true}) {
            RunnerOptions options;
            options.storage_only = storage;
            Machine machine(options, false);
            expect_twins(machine, program);
            std::printf("%s%s buffers, with copy back: %s\n", what.c_str(), storage ? "storage" : "texel",
                        timed([&] { machine.run(); }).c_str());
        }
        for (int threads : {1, 0}) {
            std::printf("%sCPU, %s: %s\n", what.c_str(), threads ? "1 thread" : "all threads",
                        timed([&] { (void)evaluate_on_cpu(program, threads); }).c_str());
        }
    }
    Program surface;
    std::mt19937 random(20);
    surface.fields.push_back(test::random_field(random, 100, 10, 1));
    test::add_surface(random, surface, 6250, 1, true);
    Machine machine({}, false);
    expect_twins(machine, surface);
    std::printf("100k vertices displaced, 100k normals, device: %s\n", timed([&] { machine.run(); }).c_str());
    std::printf("100k vertices displaced, 100k normals, CPU, 1 thread: %s\n",
                timed([&] { (void)evaluate_on_cpu(surface, 1); }).c_str());
}

}  // namespace
}  // namespace pvg
