#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "gpu/context/context.h"
#include "gpu/shaders/layout.h"

// Tests the table of features and limits that the engine needs from a Vulkan device. From the report of a
// device that meets all needs, the tests remove one need after the other.

namespace osteon::gpu {
namespace {

// Report of the present device. It must meet all needs.
DeviceReport ReportOfUsableDevice() {
  const auto context = OpenContext("", false);
  if (!context) throw std::runtime_error(context.error());
  return ReportOf(*(*context)->physical);
}

// For a need that is not a feature: how to change a report so that the need is not met, and the value that
// the refusal must name.
struct Shortfall {
  std::function<void(DeviceReport&)> apply;
  std::string found;
};
const std::map<std::string, Shortfall>& Shortfalls() {
  static const std::map<std::string, Shortfall> shortfalls{
      {"Vulkan",
       {[](DeviceReport& r) { r.properties.apiVersion = VK_MAKE_API_VERSION(0, 1, 1, 7); }, "1.1.7"}},
      {"compute queue", {[](DeviceReport& r) { r.has_compute_queue = false; }, "no"}},
      {"subgroup operations",
       {[](DeviceReport& r) { r.subgroups.supportedOperations = vk::SubgroupFeatureFlagBits::eBasic; },
        "{ Basic } in stages"}},
      {"subgroup size", {[](DeviceReport& r) { r.subgroups.subgroupSize = 128; }, "128"}},
      {"shared memory",
       {[](DeviceReport& r) { r.properties.limits.maxComputeSharedMemorySize = 16'384; }, "16384 bytes"}},
      {"workgroup size",
       {[](DeviceReport& r) {
          r.properties.deviceType = vk::PhysicalDeviceType::eDiscreteGpu;
          r.properties.limits.maxComputeWorkGroupInvocations = 128;
        },
        "128 invocations"}},
      {"storage buffers of a stage",
       {[](DeviceReport& r) { r.properties.limits.maxPerStageDescriptorStorageBuffers = kBindings - 1; },
        std::to_string(kBindings - 1)}},
  };
  return shortfalls;
}

TEST(DeviceNeeds, AreAllMetByTheDeviceThatOpens) { EXPECT_TRUE(UnmetNeeds(ReportOfUsableDevice()).empty()); }

TEST(DeviceNeeds, ASingleMissingNeedIsReportedAlone) {
  const DeviceReport usable = ReportOfUsableDevice();
  std::set<std::string> names;
  for (const DeviceNeed& need : DeviceNeeds()) {
    EXPECT_TRUE(names.insert(need.name).second) << need.name << " stands twice";
    EXPECT_NE(need.feature != nullptr, need.is_met != nullptr && need.found != nullptr) << need.name;
    DeviceReport device = usable;
    std::string found = "no";
    if (need.feature) {
      *need.feature(device.features) = VK_FALSE;
    } else {
      ASSERT_TRUE(Shortfalls().contains(need.name)) << "no device of this test lacks " << need.name;
      Shortfalls().at(need.name).apply(device);
      found = Shortfalls().at(need.name).found;
    }
    const std::vector<UnmetNeed> unmet = need.IsOptional() ? MissingOptions(device) : UnmetNeeds(device);
    EXPECT_TRUE(need.IsOptional() ? UnmetNeeds(device).empty() : MissingOptions(device).empty());
    ASSERT_EQ(unmet.size(), 1u) << need.name;
    EXPECT_EQ(unmet[0].name, need.name);
    EXPECT_TRUE(unmet[0].found.starts_with(found)) << unmet[0].found;
    EXPECT_FALSE(unmet[0].why.empty());
    EXPECT_EQ(RefusalText(unmet), need.name + ": found " + unmet[0].found + ", accepted " + need.accepted);
  }
  EXPECT_GE(names.size(), 11u);
}

TEST(DeviceNeeds, SeveralMissingNeedsAreReportedTogether) {
  DeviceReport device = ReportOfUsableDevice();
  device.features.core.shaderFloat64 = VK_FALSE;
  device.features.vulkan12.shaderBufferInt64Atomics = VK_FALSE;
  EXPECT_EQ(RefusalText(MissingOptions(device)),
            "shaderFloat64: found no, accepted yes; shaderBufferInt64Atomics: found no, accepted yes");
  EXPECT_TRUE(UnmetNeeds(device).empty());
}

TEST(DeviceNeeds, MissingOptionsChooseTheArithmetic) {
  const DeviceReport usable = ReportOfUsableDevice();
  DeviceReport no_atomics = usable, no_integers = usable, no_doubles = usable, neither = usable;
  no_atomics.features.vulkan12.shaderBufferInt64Atomics = VK_FALSE;
  no_integers.features.core.shaderInt64 = VK_FALSE;
  no_doubles.features.core.shaderFloat64 = VK_FALSE;
  neither.features.core.shaderFloat64 = VK_FALSE;
  neither.features.vulkan12.shaderBufferInt64Atomics = VK_FALSE;
  EXPECT_EQ(AvailableArithmetic(usable), Arithmetic::kInt64);
  EXPECT_EQ(AvailableArithmetic(no_atomics), Arithmetic::kWords);
  EXPECT_EQ(AvailableArithmetic(no_integers), Arithmetic::kWords);
  EXPECT_EQ(AvailableArithmetic(no_doubles), Arithmetic::kFloatsInt64);
  EXPECT_EQ(AvailableArithmetic(neither), Arithmetic::kFloats);
  EXPECT_TRUE(Offers(no_doubles, Arithmetic::kFloats));
  EXPECT_FALSE(Offers(no_doubles, Arithmetic::kWords));
  EXPECT_FALSE(Offers(no_integers, Arithmetic::kFloatsInt64));
  EXPECT_EQ(NeededFeatures(Arithmetic::kWords).core.shaderFloat64, VK_TRUE);
  EXPECT_EQ(NeededFeatures(Arithmetic::kWords).core.shaderInt64, VK_FALSE);
  EXPECT_EQ(NeededFeatures(Arithmetic::kFloatsInt64).core.shaderFloat64, VK_FALSE);
  EXPECT_EQ(NeededFeatures(Arithmetic::kFloatsInt64).vulkan12.shaderBufferInt64Atomics, VK_TRUE);
}

// An older device reports no features of Vulkan 1.2. The refusal must name its version, and not all the
// missing features.
TEST(DeviceNeeds, AnOlderVulkanIsReportedByItsVersionAlone) {
  DeviceReport device;
  device.properties.apiVersion = VK_API_VERSION_1_1;
  EXPECT_EQ(RefusalText(UnmetNeeds(device)), "Vulkan: found 1.1.0, accepted 1.2 and later");
}

// Small workgroups are accepted on a processor. A GPU would be refused for them.
TEST(DeviceNeeds, AProcessorNeedsNoWideWorkgroups) {
  DeviceReport device = ReportOfUsableDevice();
  Shortfalls().at("workgroup size").apply(device);
  device.properties.deviceType = vk::PhysicalDeviceType::eCpu;
  EXPECT_TRUE(UnmetNeeds(device).empty());
}

TEST(DeviceNeeds, OnlyTheTablesFeaturesAreRequested) {
  DeviceFeatures asked = NeededFeatures(Arithmetic::kInt64), without = NeededFeatures(Arithmetic::kFloats);
  int count = 0;
  for (const DeviceNeed& need : DeviceNeeds()) {
    if (!need.feature) continue;
    EXPECT_EQ(*need.feature(asked), VK_TRUE) << need.name;
    EXPECT_EQ(*need.feature(without), need.IsOptional() ? VK_FALSE : VK_TRUE) << need.name;
    ++count;
  }
  EXPECT_EQ(count, 4);
  EXPECT_EQ(asked.core.geometryShader, VK_FALSE) << "nothing else is asked for";
}

TEST(DeviceNeeds, TheDocumentHasTheSameTable) {
  std::ifstream file(OSTEON_SOURCE_DIR "/docs/theory/gpu_frames.md");
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  ASSERT_FALSE(page.empty());
  std::string rows;
  for (const DeviceNeed& need : DeviceNeeds())
    rows += "| " + need.name + " | " + need.accepted + " | " + need.why + " |\n";
  EXPECT_NE(page.find(rows), std::string::npos) << "the table of needs should be:\n" << rows;
}

}  // namespace
}  // namespace osteon::gpu
