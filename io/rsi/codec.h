#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "base/marker.h"
#include "io/rsi/messages.h"

// RSI datagrams to plain structs and back, in place, for the PC's side. The simulated controller (hil/rsi)
// has a codec of its own, so that the two check each other. Input is untrusted until DecodeRobot returns
// kNone.

namespace osteon::io {

inline constexpr std::size_t kRsiMaxDatagram = 2048;
inline constexpr double kRsiMaxValue = 1e6;  ///< [mm, deg] in both directions: larger than any real arm's
                                             ///< values

enum class RsiErrorCode : std::uint8_t {
  kNone = 0,
  kTooLong,    ///< more than kRsiMaxDatagram bytes
  kMalformed,  ///< not well-formed XML, or truncated
  kWrongRoot,  ///< another element than Rob, or its Type is not KUKA
  kRepeated,   ///< a repeated element or attribute
  kMissing,    ///< a needed element, or one of its attributes, is missing
  kNumber,     ///< not a number, not finite, or out of the field's range
  kNoSpace,    ///< the caller's buffer is too small
};

/// Why and where a datagram was refused. Plain data, made in the tick.
struct RsiError {
  RsiErrorCode code{RsiErrorCode::kNone};
  RsiElement element{RsiElement::kNone};  ///< the element concerned, if any
  std::uint8_t attribute{0};              ///< 1 … 6: A1 … A6, X … C, D; 0: none, or the element itself
  std::uint16_t byte{0};                  ///< where reading stopped

  [[nodiscard]] explicit operator bool() const { return code != RsiErrorCode::kNone; }
};

/// One line, e.g. "AIPos: attribute 4 is missing (byte 212)"; not for the tick.
[[nodiscard]] std::string Describe(const RsiError& error);

/// Parses and checks a controller's message. Attributes and elements in any order, unknown ones skipped;
/// numbers in the C locale, regardless of the process's locale. Every element present must be complete
/// (except EIPos).
/// @param needed  elements without which the message is refused, besides IPOC (RsiElement bits)
/// @returns code kNone if `message` was set; otherwise it is unchanged.
[[nodiscard]] RsiError DecodeRobot(std::span<const std::uint8_t> datagram, std::uint16_t needed,
                                   RsiRobotMessage& message) OSTEON_RT;

/// Writes an answer, byte for byte as documented in README.md: one space between attributes, double quotes,
/// no other white space, fixed decimals, never an exponent or a minus before zero.
/// @param decimals  0 … 9, of the correction
/// @returns kNumber if a value is not finite or beyond ±1e6, or decimals is out of range; kNoSpace. `size` is
///   the datagram's length on kNone.
[[nodiscard]] RsiErrorCode EncodeAnswer(const RsiAnswer& answer, int decimals, std::span<std::uint8_t> buffer,
                                        std::size_t& size) OSTEON_RT;

/// The number that EncodeAnswer writes: `value` rounded to `decimals`.
[[nodiscard]] double RsiRounded(double value, int decimals) OSTEON_RT;

}  // namespace osteon::io
