#pragma once

// Inside gpu only: this header brings vulkan_raii.hpp.

#include <atomic>
#include <cstdint>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>
#include <vulkan/vulkan_raii.hpp>

#include "gpu/devices.h"

namespace osteon::gpu {

/// What a process has of Vulkan but once, since drivers do not take any number of openings (one gives up
/// after 29), or twice: without the validation layers and under them.
struct SharedInstance {
  vk::raii::Context loader;
  std::atomic<int> messages{0};  ///< of the validation layers, about all devices; they go to stderr
  std::string loader_errors;  ///< that the loader reported while the instance was made; outlives the instance
  std::optional<vk::raii::Instance> instance;
  std::optional<vk::raii::DebugUtilsMessengerEXT> messenger;  ///< where the layers are there
};

/// Subgroups of a device: invocations of a workgroup that run in step.
struct Subgroups {
  std::uint32_t size{0};  ///< what a pass gets that asks for none
  bool can_choose{false};
  std::uint32_t min_size{0}, max_size{0};  ///< where a pass can choose, powers of two
  bool can_be_full{false};                 ///< a pass can ask that none of its invocations be left out
};

/// Device and one compute queue.
struct Context {
  std::shared_ptr<SharedInstance> shared;  ///< lives as long as any device of it, and to the process's end
  bool validation{false};                  ///< under the layers
  std::optional<vk::raii::PhysicalDevice> physical;
  std::optional<vk::raii::Device> device;
  std::optional<vk::raii::Queue> queue;
  std::uint32_t queue_family{0};
  DeviceInfo info;
  Subgroups subgroups;
};

/// @param name  part of a device's name, in any case; empty: the default device.
[[nodiscard]] tl::expected<std::unique_ptr<Context>, std::string> OpenContext(const std::string& name,
                                                                              bool validation);

/// Why Vulkan could not be opened, for the user: what to install where loader, driver or layers are missing,
/// else what Vulkan said.
[[nodiscard]] std::string OpeningFailure(const std::exception& error);

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

/// The name, for the validation layers' messages, of the buffer that holds a frame.
inline constexpr const char* kFrameBufferName = "frame";
/// Names a buffer in their messages; nothing without the layers.
void NameForLayers(const Context& context, const Buffer& buffer, const char* name);

/// The types of memory that a buffer can lie in, those that its placement asks for first; types whose heap is
/// smaller than the buffer are left out (a window into a card's memory often has 256 MB).
[[nodiscard]] std::vector<std::uint32_t> MemoryTypes(const vk::PhysicalDeviceMemoryProperties& memory,
                                                     const vk::MemoryRequirements& needs,
                                                     Placement placement);

/// The first of the types for which `allocate(type)` does not throw vk::OutOfDeviceMemoryError or
/// vk::OutOfHostMemoryError. @throws vk::OutOfDeviceMemoryError where there is none.
template <class Allocate>
std::uint32_t AllocateFromFirst(const std::vector<std::uint32_t>& types, Allocate allocate) {
  for (const std::uint32_t type : types) {
    try {
      allocate(type);
      return type;
    } catch (const vk::OutOfDeviceMemoryError&) {  // the next one, then
    } catch (const vk::OutOfHostMemoryError&) {
    }
  }
  throw vk::OutOfDeviceMemoryError("none of " + std::to_string(types.size()) + " memory types has room");
}

/// @throws vk::SystemError where memory does not suffice.
[[nodiscard]] Buffer MakeBuffer(const Context& context, vk::DeviceSize size, Placement placement);

}  // namespace osteon::gpu
