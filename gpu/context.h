#pragma once

// Inside gpu only: this header brings vulkan_raii.hpp.

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>
#include <vulkan/vulkan_raii.hpp>

#include "gpu/devices.h"

namespace osteon::gpu {

/// Counts what the validation layers say; the messages go to stderr.
struct ValidationLog {
  std::atomic<int> messages{0};
};

/// Instance, device and one compute queue.
struct Context {
  vk::raii::Context loader;
  std::unique_ptr<ValidationLog> validation;  ///< null where the layers were not asked for
  std::optional<vk::raii::Instance> instance;
  std::optional<vk::raii::DebugUtilsMessengerEXT> messenger;
  std::optional<vk::raii::PhysicalDevice> physical;
  std::optional<vk::raii::Device> device;
  std::optional<vk::raii::Queue> queue;
  std::uint32_t queue_family{0};
  DeviceInfo info;
};

/// @param name  part of a device's name, in any case; empty: the default device.
[[nodiscard]] tl::expected<std::unique_ptr<Context>, std::string> OpenContext(const std::string& name,
                                                                              bool validation);

/// A buffer with memory of its own.
struct Buffer {
  vk::raii::DeviceMemory memory{nullptr};
  vk::raii::Buffer buffer{nullptr};
  void* mapped{nullptr};
  vk::DeviceSize size{0};
  bool device_local{false};
};

/// Where a buffer lies: on the device; in host memory, to write to it or to read from it; or on the device
/// where the host can write to it, if there is such memory.
enum class Placement { kDevice, kUpload, kReadBack, kShared };

/// @throws vk::SystemError where memory does not suffice.
[[nodiscard]] Buffer MakeBuffer(const Context& context, vk::DeviceSize size, Placement placement);

}  // namespace osteon::gpu
