#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

namespace osteon::gpu {

/// Number formats in which the passes compute values that need more than 32 bits. A device uses the first
/// one, in this order, whose features it has.
enum class Arithmetic : std::uint8_t {
  kAuto,   ///< the first of the following that the device's features allow
  kInt64,  ///< doubles, and 64-bit integers with atomic operations
  kWords,  ///< doubles; 64-bit integers as two words of 32 bits: the same results as kInt64, with three more
           ///< passes
  kFloatsInt64,  ///< doubles as two floats (nearly the same results as kInt64); 64-bit integers
  kFloats,       ///< doubles as two floats; 64-bit integers as two words of 32 bits
};
/// HasDoubles: whether an arithmetic needs shaderFloat64. HasInt64: whether it needs shaderInt64 and
/// shaderBufferInt64Atomics.
[[nodiscard]] constexpr bool HasDoubles(Arithmetic a) {
  return a == Arithmetic::kInt64 || a == Arithmetic::kWords;
}
[[nodiscard]] constexpr bool HasInt64(Arithmetic a) {
  return a == Arithmetic::kInt64 || a == Arithmetic::kFloatsInt64;
}

/// A feature or limit that the cutting engine needs and that a device lacks.
struct UnmetNeed {
  std::string name;      ///< e.g. "shaderFloat64"
  std::string found;     ///< e.g. "no"
  std::string accepted;  ///< e.g. "yes"
  std::string why;       ///< purpose for which the engine needs it
};

/// One Vulkan device of this machine.
struct DeviceInfo {
  std::string name;                ///< as the driver reports it, e.g. "llvmpipe (LLVM 15.0.6, 256 bits)"
  std::string kind;                ///< "discrete", "integrated", "virtual", "cpu" or "other"
  std::string api_version;         ///< e.g. "1.3.239"
  std::string driver;              ///< e.g. "llvmpipe Mesa 22.3.6"
  double memory_bytes{0.0};        ///< size of its largest device-local heap
  std::string refusal;             ///< why the cutting engine cannot use it, in one line; empty if it can
  std::vector<UnmetNeed> unmet{};  ///< the unmet needs that `refusal` lists
  Arithmetic arithmetic{Arithmetic::kInt64};  ///< the first arithmetic that the device's features allow
  std::vector<UnmetNeed> missing{};  ///< features of kInt64 that the device lacks; empty if it has all
};

/// Describes an arithmetic: "doubles and 64-bit integers", "doubles, and two words for each 64-bit integer" …
[[nodiscard]] std::string ArithmeticText(Arithmetic arithmetic);

/// Lists the names of needs: "shaderInt64, shaderBufferInt64Atomics".
[[nodiscard]] std::string NeedNames(std::span<const UnmetNeed> needs);

/// Lists all Vulkan devices, the default one first (discrete before integrated, virtual and cpu).
/// @returns an error that says what to install if there is no Vulkan loader or no driver.
[[nodiscard]] tl::expected<std::vector<DeviceInfo>, std::string> ListDevices();

}  // namespace osteon::gpu
