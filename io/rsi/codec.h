#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "control/rt/marker.h"
#include "io/rsi/messages.h"

// RSI datagrams to plain structs and back, in place: what the PC reads and writes. The simulated controller
// (hil/rsi) has a codec of its own, so that the two check each other. What comes in is hostile until
// DecodeRobot has said kNone.

namespace osteon::io {

inline constexpr std::size_t kRsiMaxDatagram = 2048;
inline constexpr double kRsiMaxValue = 1e6;  ///< [mm, deg] either way: beyond it no arm of this world is

enum class RsiErrorCode : std::uint8_t {
  kNone = 0,
  kTooLong,    ///< more than kRsiMaxDatagram bytes
  kMalformed,  ///< not well-formed XML, or cut off
  kWrongRoot,  ///< another element than Rob, or its Type is not KUKA
  kRepeated,   ///< an element or an attribute twice
  kMissing,    ///< an element that is needed, or one of its attributes, is not there
  kNumber,     ///< not a number, not a finite one, or out of the field's range
  kNoSpace,    ///< the caller's buffer is too small
};

/// Why and where a datagram was refused. Plain data, made in the tick.
struct RsiError {
  RsiErrorCode code{RsiErrorCode::kNone};
  RsiElement element{RsiElement::kNone};  ///< that it is about, where it is about one
  std::uint8_t attribute{0};              ///< 1 … 6: A1 … A6, X … C, D; 0: none, or the element itself
  std::uint16_t byte{0};                  ///< where reading stopped

  [[nodiscard]] explicit operator bool() const { return code != RsiErrorCode::kNone; }
};

/// One line, e.g. "AIPos: attribute 4 is missing (byte 212)"; not for the tick.
[[nodiscard]] std::string Describe(const RsiError& error);

/// Parses and checks what the controller sent. Attributes and elements in any order, unknown ones skipped;
/// numbers in the C locale whatever the process's is. An element that is there has to be complete (but
/// EIPos).
/// @param needed  elements without which the message is refused, besides IPOC (RsiElement bits)
/// @returns code kNone where `message` was set; otherwise it is unchanged.
[[nodiscard]] RsiError DecodeRobot(std::span<const std::uint8_t> datagram, std::uint16_t needed,
                                   RsiRobotMessage& message) OSTEON_RT;

/// Writes an answer, byte for byte as documented in README.md: one space between attributes, double quotes,
/// no other white space, fixed decimals, never an exponent or a minus before zero.
/// @param decimals  0 … 9, of the correction
/// @returns kNumber where a value is not finite or beyond ±1e6, or decimals is out of range; kNoSpace. `size`
/// is
///   the datagram's length on kNone.
[[nodiscard]] RsiErrorCode EncodeAnswer(const RsiAnswer& answer, int decimals, std::span<std::uint8_t> buffer,
                                        std::size_t& size) OSTEON_RT;

/// The value that EncodeAnswer's text stands for: rounded to `decimals`.
[[nodiscard]] double RsiRounded(double value, int decimals) OSTEON_RT;

}  // namespace osteon::io
