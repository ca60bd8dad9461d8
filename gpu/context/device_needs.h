#pragma once

// For files of gpu/ only: this header includes vulkan.hpp.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <vulkan/vulkan.hpp>

#include "gpu/context/devices.h"

namespace osteon::gpu {

/// Smallest subgroup size that the passes support: their shared memory has room for the results of kWideLanes
/// / 4 subgroups.
inline constexpr std::uint32_t kMinSubgroup = 4;

/// Features that a device offers, or that the engine requests when it opens the device.
struct DeviceFeatures {
  vk::PhysicalDeviceFeatures core;
  vk::PhysicalDeviceVulkan12Features vulkan12;
};

/// The properties of a device that the engine's needs are about.
struct DeviceReport {
  vk::PhysicalDeviceProperties properties;
  vk::PhysicalDeviceSubgroupProperties subgroups;
  DeviceFeatures features;
  bool has_compute_queue{false};
};

/// One requirement of the cutting engine on a device: a feature, which the engine also requests when it opens
/// the device, or another property.
struct DeviceNeed {
  std::string name, accepted, why;
  vk::Bool32* (*feature)(DeviceFeatures&){nullptr};    ///< nullptr for another property
  bool (*is_met)(const DeviceReport&){nullptr};        ///< nullptr for a feature
  std::string (*found)(const DeviceReport&){nullptr};  ///< nullptr for a feature
  bool (*serves)(Arithmetic){nullptr};                 ///< whether an arithmetic has this need; nullptr: all

  [[nodiscard]] bool IsOptional() const { return serves != nullptr; }
};

/// All needs, in the order of docs/theory/gpu_frames.md#limits. The first need is the API's version. If a
/// device does not meet it, the other needs are not checked.
[[nodiscard]] std::span<const DeviceNeed> DeviceNeeds();

/// Formats a version that Vulkan packs into one number, e.g. "1.3.239".
[[nodiscard]] std::string ApiVersionText(std::uint32_t version);

/// The needs that a device does not meet; empty if the engine can use the device.
[[nodiscard]] std::vector<UnmetNeed> UnmetNeeds(const DeviceReport& report);

/// Whether a device has the features of an arithmetic.
[[nodiscard]] bool Offers(const DeviceReport& report, Arithmetic arithmetic);

/// The first arithmetic for which a device has the features.
[[nodiscard]] Arithmetic AvailableArithmetic(const DeviceReport& report);

/// The optional needs that a device does not meet; empty if the device has all features of
/// Arithmetic::kInt64.
[[nodiscard]] std::vector<UnmetNeed> MissingOptions(const DeviceReport& report);

/// The features that the engine requests for this arithmetic.
[[nodiscard]] DeviceFeatures NeededFeatures(Arithmetic arithmetic);

/// Formats unmet needs: "shaderFloat64: found no, accepted yes; …"; empty if there are none.
[[nodiscard]] std::string RefusalText(std::span<const UnmetNeed> unmet);

}  // namespace osteon::gpu
