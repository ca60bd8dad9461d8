#include "gpu/context/device_needs.h"

#include <algorithm>

#include <fmt/format.h>

#include "gpu/shaders/layout.h"

namespace osteon::gpu {
namespace {

// Subgroup operations that the passes use.
const vk::SubgroupFeatureFlags kSubgroupNeeds =
    vk::SubgroupFeatureFlagBits::eBasic | vk::SubgroupFeatureFlagBits::eArithmetic |
    vk::SubgroupFeatureFlagBits::eBallot | vk::SubgroupFeatureFlagBits::eVote;

constexpr std::uint32_t kSharedMemory = 32'000;  // bytes of shared memory that a workgroup may use

// Largest number of invocations along x that a device allows in a workgroup. On a GPU some passes need
// kWideLanes; on a processor all passes need fewer than the number that Vulkan guarantees.
std::uint32_t MaxInvocations(const DeviceReport& report) {
  const vk::PhysicalDeviceLimits& limits = report.properties.limits;
  return std::min(limits.maxComputeWorkGroupInvocations, limits.maxComputeWorkGroupSize[0]);
}

// Makes the list that DeviceNeeds returns.
std::vector<DeviceNeed> MakeNeeds() {
  return {
      {.name = "Vulkan",
       .accepted = "1.2 and later",
       .why = "layouts, subgroups and features are those of its core",
       .is_met =
           [](const DeviceReport& device) { return device.properties.apiVersion >= VK_API_VERSION_1_2; },
       .found = [](const DeviceReport& device) { return ApiVersionText(device.properties.apiVersion); }},
      {.name = "compute queue",
       .accepted = "yes",
       .why = "every pass is a compute shader",
       .is_met = [](const DeviceReport& device) { return device.has_compute_queue; },
       .found = [](const DeviceReport&) { return std::string("no"); }},
      {.name = "scalarBlockLayout",
       .accepted = "yes",
       .why = "a buffer has the same layout in shaders and in C++",
       .feature = [](DeviceFeatures& f) { return &f.vulkan12.scalarBlockLayout; }},
      {.name = "shaderFloat64",
       .accepted = "yes",
       .why = "double precision decides what floats can't tell",
       .feature = [](DeviceFeatures& f) { return &f.core.shaderFloat64; },
       .serves = HasDoubles},
      {.name = "shaderInt64",
       .accepted = "yes",
       .why = "keys of pairs and exact sums have 64 bits",
       .feature = [](DeviceFeatures& f) { return &f.core.shaderInt64; },
       .serves = HasInt64},
      {.name = "shaderBufferInt64Atomics",
       .accepted = "yes",
       .why = "all workgroups find one smallest key and add to one exact sum",
       .feature = [](DeviceFeatures& f) { return &f.vulkan12.shaderBufferInt64Atomics; },
       .serves = HasInt64},
      {.name = "subgroup operations",
       .accepted = "Basic, Vote, Arithmetic and Ballot in compute shaders",
       .why = "a subgroup combines its results before it writes them",
       .is_met =
           [](const DeviceReport& device) {
             return (device.subgroups.supportedOperations & kSubgroupNeeds) == kSubgroupNeeds &&
                    (device.subgroups.supportedStages & vk::ShaderStageFlagBits::eCompute);
           },
       .found =
           [](const DeviceReport& device) {
             return vk::to_string(device.subgroups.supportedOperations & kSubgroupNeeds) + " in stages " +
                    vk::to_string(device.subgroups.supportedStages);
           }},
      {.name = "subgroup size",
       .accepted = fmt::format("{} … {}", kMinSubgroup, kGroupSize),
       .why = "shared memory has places for 64 subgroups, and a cluster is one workgroup",
       .is_met =
           [](const DeviceReport& device) {
             return device.subgroups.subgroupSize >= kMinSubgroup &&
                    device.subgroups.subgroupSize <= kGroupSize;
           },
       .found = [](const DeviceReport& device) { return fmt::to_string(device.subgroups.subgroupSize); }},
      {.name = "shared memory",
       .accepted = fmt::format("at least {} bytes", kSharedMemory),
       .why = "a workgroup combines its keys and sums there",
       .is_met =
           [](const DeviceReport& device) {
             return device.properties.limits.maxComputeSharedMemorySize >= kSharedMemory;
           },
       .found =
           [](const DeviceReport& device) {
             return fmt::format("{} bytes", device.properties.limits.maxComputeSharedMemorySize);
           }},
      {.name = "workgroup size",
       .accepted = fmt::format("at least {} invocations on a GPU", kWideLanes),
       .why = "wide workgroups need fewer atomic additions",
       .is_met =
           [](const DeviceReport& device) {
             return device.properties.deviceType == vk::PhysicalDeviceType::eCpu ||
                    MaxInvocations(device) >= kWideLanes;
           },
       .found =
           [](const DeviceReport& device) { return fmt::format("{} invocations", MaxInvocations(device)); }},
      {.name = "storage buffers of a stage",
       .accepted = fmt::format("at least {}", kBindings),
       .why = "all passes share one set of buffers",
       .is_met =
           [](const DeviceReport& device) {
             return device.properties.limits.maxPerStageDescriptorStorageBuffers >= kBindings;
           },
       .found =
           [](const DeviceReport& device) {
             return fmt::to_string(device.properties.limits.maxPerStageDescriptorStorageBuffers);
           }},
  };
}

}  // namespace

std::string ApiVersionText(std::uint32_t version) {
  return fmt::format("{}.{}.{}", VK_API_VERSION_MAJOR(version), VK_API_VERSION_MINOR(version),
                     VK_API_VERSION_PATCH(version));
}

std::span<const DeviceNeed> DeviceNeeds() {
  static const std::vector<DeviceNeed> needs = MakeNeeds();
  return needs;
}

namespace {

// The required or the optional needs that a device does not meet. If the first need, Vulkan's version, is
// unmet, the others are not checked.
std::vector<UnmetNeed> FindUnmet(const DeviceReport& report, bool optional) {
  std::vector<UnmetNeed> unmet;
  DeviceFeatures features = report.features;
  for (const DeviceNeed& need : DeviceNeeds()) {
    if (need.IsOptional() != optional) continue;
    const bool met = need.feature ? *need.feature(features) == VK_TRUE : need.is_met(report);
    if (met) continue;
    unmet.push_back({.name = need.name,
                     .found = need.found ? need.found(report) : "no",
                     .accepted = need.accepted,
                     .why = need.why});
    if (&need == &DeviceNeeds().front()) break;
  }
  return unmet;
}

}  // namespace

std::vector<UnmetNeed> UnmetNeeds(const DeviceReport& report) { return FindUnmet(report, false); }
std::vector<UnmetNeed> MissingOptions(const DeviceReport& report) { return FindUnmet(report, true); }

bool Offers(const DeviceReport& report, Arithmetic arithmetic) {
  DeviceFeatures features = report.features;
  return std::ranges::all_of(DeviceNeeds(), [&](const DeviceNeed& need) {
    return !need.IsOptional() || !need.serves(arithmetic) || *need.feature(features) == VK_TRUE;
  });
}

Arithmetic AvailableArithmetic(const DeviceReport& report) {
  for (const Arithmetic arithmetic : {Arithmetic::kInt64, Arithmetic::kWords, Arithmetic::kFloatsInt64})
    if (Offers(report, arithmetic)) return arithmetic;
  return Arithmetic::kFloats;
}

std::string ArithmeticText(Arithmetic arithmetic) {
  switch (arithmetic) {
    case Arithmetic::kFloats:
      return "two floats for each double, two words for each 64-bit integer";
    case Arithmetic::kFloatsInt64:
      return "two floats for each double, and 64-bit integers";
    case Arithmetic::kWords:
      return "doubles, and two words for each 64-bit integer";
    default:
      return "doubles and 64-bit integers";
  }
}

std::string NeedNames(std::span<const UnmetNeed> needs) {
  std::string names;
  for (const UnmetNeed& need : needs) names += (names.empty() ? "" : ", ") + need.name;
  return names;
}

DeviceFeatures NeededFeatures(Arithmetic arithmetic) {
  DeviceFeatures features;
  for (const DeviceNeed& need : DeviceNeeds())
    if (need.feature && (!need.serves || need.serves(arithmetic))) *need.feature(features) = VK_TRUE;
  return features;
}

std::string RefusalText(std::span<const UnmetNeed> unmet) {
  std::string text;
  for (const UnmetNeed& need : unmet)
    text += fmt::format("{}{}: found {}, accepted {}", text.empty() ? "" : "; ", need.name, need.found,
                        need.accepted);
  return text;
}

}  // namespace osteon::gpu
