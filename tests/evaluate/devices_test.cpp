// Which device is taken, and what is said when there is none.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "pvg/vulkan.h"
#include "vulkan/instance.h"

namespace pvg {
namespace {

using vulkan::Candidate;
using vulkan::pick_device;

Candidate candidate(const std::string& name, const std::string& type, bool usable = true, bool preferred = false) {
    Candidate result;
    result.info.name = name;
    result.info.type = type;
    result.info.usable = usable;
    result.info.preferred = preferred;
    if (!usable)
        result.info.reason = "it has no compute queue";
    return result;
}

const std::vector<Candidate> several{candidate("llvmpipe (LLVM)", "cpu"), candidate("Radeon 780M", "integrated"),
                                     candidate("GeForce RTX", "discrete", true, true),
                                     candidate("Old GeForce", "discrete", false)};

TEST(PickDevice, ByPreferenceIndexAndName) {
    EXPECT_EQ(pick_device(several, ""), 2u);
    EXPECT_EQ(pick_device(several, "0"), 0u);
    EXPECT_EQ(pick_device(several, "LLVMPIPE"), 0u);
    EXPECT_EQ(pick_device(several, "radeon"), 1u);
    EXPECT_EQ(pick_device(several, "GeForce"), 2u);  // the usable one of two
    EXPECT_EQ(pick_device(several, "780"), 1u);      // no such index: part of a name
}

TEST(PickDevice, FailuresListWhatWasFound) {
    for (const std::string wanted : {"Intel", "3", "old geforce", "99"}) {
        try {
            (void)pick_device(several, wanted);
            FAIL() << wanted;
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::device);
            const std::string text = error.what();
            EXPECT_NE(text.find(wanted), std::string::npos) << text;
            for (const Candidate& c : several) EXPECT_NE(text.find(c.info.name), std::string::npos) << text;
            EXPECT_NE(text.find("no compute queue"), std::string::npos) << text;
        }
    }
    EXPECT_THROW((void)pick_device({}, ""), Error);
    EXPECT_THROW((void)pick_device({candidate("x", "cpu", false)}, ""), Error);
}

TEST(Devices, ListIsConsistent) {
    const auto devices = list_vulkan_devices();
    ASSERT_TRUE(devices) << devices.error().what();
    if (devices.value().empty())
        GTEST_SKIP() << "no Vulkan device";
    int preferred = 0;
    bool usable = false;
    for (const VulkanDeviceInfo& info : devices.value()) {
        EXPECT_FALSE(info.name.empty());
        EXPECT_FALSE(info.driver.empty());
        EXPECT_GE(info.api_major, 1u);
        EXPECT_EQ(info.usable, info.reason.empty());
        preferred += info.preferred;
        usable = usable || info.usable;
    }
    EXPECT_EQ(preferred, usable ? 1 : 0);
}

TEST(Devices, CreateTakesWhatIsAskedFor) {
    const auto devices = list_vulkan_devices();
    ASSERT_TRUE(devices);
    for (std::size_t i = 0; i < devices.value().size(); ++i) {
        const VulkanDeviceInfo& info = devices.value()[i];
        if (!info.usable)
            continue;
        const auto by_index = VulkanEvaluator::create({std::to_string(i), false});
        ASSERT_TRUE(by_index) << by_index.error().what();
        EXPECT_EQ(by_index.value().device().name, info.name);
    }
    const auto wrong = VulkanEvaluator::create({"no such device", false});
    ASSERT_FALSE(wrong);
    EXPECT_EQ(wrong.error().kind(), ErrorKind::device);
    if (devices.value().empty())
        GTEST_SKIP() << "no Vulkan device";
}

TEST(Devices, WithoutADriverThereAreNone) {
    for (const char* name : {"VK_ICD_FILENAMES", "VK_DRIVER_FILES"}) ASSERT_EQ(setenv(name, "/nonexistent/icd.json", 1), 0);
    const auto devices = list_vulkan_devices();
    const auto evaluator = VulkanEvaluator::create({});
    for (const char* name : {"VK_ICD_FILENAMES", "VK_DRIVER_FILES"}) unsetenv(name);
    ASSERT_TRUE(devices) << devices.error().what();
    EXPECT_TRUE(devices.value().empty());
    ASSERT_FALSE(evaluator);
    EXPECT_EQ(evaluator.error().kind(), ErrorKind::device);
    EXPECT_NE(std::string(evaluator.error().what()).find("no usable device"), std::string::npos) << evaluator.error().what();
}

}  // namespace
}  // namespace pvg
