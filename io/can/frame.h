#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "base/clock.h"
#include "base/marker.h"

namespace osteon::io {

inline constexpr std::uint16_t kCanMaxId = 0x7FF;  ///< largest identifier of 11 bits

/// A classical CAN data frame with an 11-bit identifier. Bytes beyond `size` are zero, so that equal frames
/// compare equal.
struct CanFrame {
  std::uint16_t id{0};   ///< 0 … 0x7FF
  std::uint8_t size{0};  ///< 0 … 8
  std::array<std::uint8_t, 8> data{};

  friend bool operator==(const CanFrame&, const CanFrame&) = default;
};

/// A frame as received from a bus.
struct CanArrival {
  CanFrame frame;
  rt::Nanoseconds stamp{0};  ///< time of arrival at this machine, on CLOCK_MONOTONIC (or virtual time)
  bool after_gap{false};     ///< the transport has detected that frames before this one were lost
};

/// Formats an identifier for error texts, e.g. "0x064".
[[nodiscard]] std::string IdText(std::uint16_t id);

}  // namespace osteon::io
