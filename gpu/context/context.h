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

/// A Vulkan instance of the process. The process has at most two: one without and one with the validation
/// layers. Each is made only once because drivers limit the number of instances (one driver fails after 29).
struct SharedInstance {
  vk::raii::Context loader;
  std::atomic<int> messages{0};  ///< validation messages so far, of all devices; texts go to stderr
  std::string loader_errors;     ///< errors that the loader reported while the instance was made; declared
                                 ///< first, so it outlives the instance
  std::optional<vk::raii::Instance> instance;
  std::optional<vk::raii::DebugUtilsMessengerEXT> messenger;  ///< only with the layers
};

/// Subgroup sizes of a device. A subgroup is a set of invocations of a workgroup that execute together.
struct Subgroups {
  std::uint32_t size{0};  ///< size of a subgroup in a pass that requests no size
  bool can_choose{false};
  std::uint32_t min_size{0}, max_size{0};  ///< range of sizes that a pass can request; both are powers of two
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
  /// The shaders may use fma() to compute the rounding error of a float product (HasFusedFma). Measured only
  /// for arithmetic without doubles, which alone needs it.
  bool fused_fma{false};
};

/// Reads those properties of a device that the engine's needs are about.
[[nodiscard]] DeviceReport ReportOf(const vk::raii::PhysicalDevice& device);

/// Opens the first usable device, in the order of ListDevices, whose name contains `name`.
/// @param name        part of a device's name, upper or lower case; empty: the default device.
/// @param arithmetic  arithmetic whose optional features the device opens with; kAuto: the first arithmetic
/// that the device supports.
/// @returns an error for the user that names the devices found, or says what to install.
[[nodiscard]] tl::expected<std::unique_ptr<Context>, std::string> OpenContext(
    const std::string& name, bool validation, Arithmetic arithmetic = Arithmetic::kAuto);

/// Returns the reason why Vulkan could not be opened, for the user: what to install if loader, driver or
/// layers are missing, otherwise Vulkan's own message.
[[nodiscard]] std::string OpeningFailure(const std::exception& error);

/// A buffer with its own memory.
struct Buffer {
  vk::raii::DeviceMemory memory{nullptr};
  vk::raii::Buffer buffer{nullptr};
  void* mapped{nullptr};     ///< address of the memory on the host; nullptr for Placement::kDevice
  vk::DeviceSize size{0};    ///< bytes
  bool device_local{false};  ///< the memory is device-local
};

/// Location of a buffer. kDevice: on the device. kUpload, kReadBack: in host memory, for writing or for
/// reading by the host. kShared: on the device in memory that the host can write to, or in host memory if the
/// device has no such memory.
enum class Placement { kDevice, kUpload, kReadBack, kShared };

/// Name of the buffer that holds a frame, in the validation layers' messages.
inline constexpr const char* kFrameBufferName = "frame";
/// Names a buffer in the layers' messages; does nothing without the layers.
void NameForLayers(const Context& context, const Buffer& buffer, const char* name);

/// Memory types that a buffer can use, in the placement's order of preference. Types whose heap is smaller
/// than the buffer are left out (a host-visible window into a card's memory often has 256 MB).
[[nodiscard]] std::vector<std::uint32_t> MemoryTypes(const vk::PhysicalDeviceMemoryProperties& memory,
                                                     const vk::MemoryRequirements& needs,
                                                     Placement placement);

/// Returns the first of the types for which `allocate(type)` does not throw vk::OutOfDeviceMemoryError or
/// vk::OutOfHostMemoryError. @throws vk::OutOfDeviceMemoryError if no type succeeds.
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
