#pragma once

// For files of gpu/ only: this header includes vulkan_raii.hpp.

#include <atomic>
#include <cstdint>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>
#include <vulkan/vulkan_raii.hpp>

#include "gpu/context/device_needs.h"
#include "gpu/context/devices.h"

namespace osteon::gpu {

/// The process's Vulkan instance, of which there is one without the validation layers and one with them. It
/// is made only once because drivers limit the number of instances (one fails after 29).
struct SharedInstance {
  vk::raii::Context loader;
  std::atomic<int> messages{0};  ///< number of validation messages, about all devices; text goes to stderr
  std::string loader_errors;  ///< reported by the loader while the instance was made; outlives the instance
  std::optional<vk::raii::Instance> instance;
  std::optional<vk::raii::DebugUtilsMessengerEXT> messenger;  ///< only with the layers
};

/// Subgroups of a device: invocations of a workgroup that execute together.
struct Subgroups {
  std::uint32_t size{0};  ///< size for a pass that requests none
  bool can_choose{false};
  std::uint32_t min_size{0}, max_size{0};  ///< range of sizes that a pass can request, powers of two
  bool can_be_full{false};                 ///< a pass can require that all its invocations are active
};

/// Device and one compute queue.
struct Context {
  std::shared_ptr<SharedInstance> shared;  ///< kept until the process's end
  bool validation{false};                  ///< with the validation layers
  std::optional<vk::raii::PhysicalDevice> physical;
  std::optional<vk::raii::Device> device;
  std::optional<vk::raii::Queue> queue;
  std::uint32_t queue_family{0};
  DeviceInfo info;
  Arithmetic arithmetic{Arithmetic::kInt64};  ///< not kAuto
  Subgroups subgroups;
  /// The shaders may use fma() for the rounding error of a float product (HasFusedFma). Only found out, and
  /// only needed, for arithmetic without doubles.
  bool fused_fma{false};
};

/// Reads a device's properties.
[[nodiscard]] DeviceReport ReportOf(const vk::raii::PhysicalDevice& device);

/// Opens a device: the first usable one with this name, in the order of ListDevices.
/// @param name        part of a device's name, in any case; empty: the default device.
/// @param arithmetic  which optional features the device opens with; kAuto: those that it has.
/// @returns an error for the user that names the devices found, or says what to install.
[[nodiscard]] tl::expected<std::unique_ptr<Context>, std::string> OpenContext(
    const std::string& name, bool validation, Arithmetic arithmetic = Arithmetic::kAuto);

/// Reason why Vulkan could not be opened, for the user: what to install where loader, driver or layers are
/// missing, otherwise Vulkan's own message.
[[nodiscard]] std::string OpeningFailure(const std::exception& error);

/// A buffer with its own memory.
struct Buffer {
  vk::raii::DeviceMemory memory{nullptr};
  vk::raii::Buffer buffer{nullptr};
  void* mapped{nullptr};     ///< the memory as the host sees it; nullptr for Placement::kDevice
  vk::DeviceSize size{0};    ///< bytes
  bool device_local{false};  ///< the memory is the device's own
};

/// Location of a buffer: on the device; in host memory for writing or for reading; or on the device in memory
/// that the host can write to, if there is any.
enum class Placement { kDevice, kUpload, kReadBack, kShared };

/// Name of the buffer that holds a frame, in the validation layers' messages.
inline constexpr const char* kFrameBufferName = "frame";
/// Names a buffer in the layers' messages; does nothing without the layers.
void NameForLayers(const Context& context, const Buffer& buffer, const char* name);

/// Memory types that a buffer can use, in order of the placement's preference. Types whose heap is smaller
/// than the buffer are left out (a host-visible window into a card's memory often has 256 MB).
[[nodiscard]] std::vector<std::uint32_t> MemoryTypes(const vk::PhysicalDeviceMemoryProperties& memory,
                                                     const vk::MemoryRequirements& needs,
                                                     Placement placement);

/// Returns the first of the types for which `allocate(type)` does not throw vk::OutOfDeviceMemoryError or
/// vk::OutOfHostMemoryError. @throws vk::OutOfDeviceMemoryError where there is none.
template <class Allocate>
std::uint32_t AllocateFromFirst(const std::vector<std::uint32_t>& types, Allocate allocate) {
  for (const std::uint32_t type : types) {
    try {
      allocate(type);
      return type;
    } catch (const vk::OutOfDeviceMemoryError&) {  // try the next one
    } catch (const vk::OutOfHostMemoryError&) {
    }
  }
  throw vk::OutOfDeviceMemoryError("none of " + std::to_string(types.size()) + " memory types has room");
}

/// Makes a buffer of at least `size` bytes. @throws vk::SystemError where memory does not suffice.
[[nodiscard]] Buffer MakeBuffer(const Context& context, vk::DeviceSize size, Placement placement);

}  // namespace osteon::gpu
