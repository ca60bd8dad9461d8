#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "base/marker.h"
#include "io/rsi/messages.h"

// Converts RSI datagrams to plain structs and back, in place, for the PC's side. The simulated controller
// (hil/rsi) has a separate codec, so that the two codecs check each other. A decoded message may be used only
// if DecodeRobot returned kNone.

namespace osteon::io {

inline constexpr std::size_t kRsiMaxDatagram = 2048;
/// largest magnitude of a value [mm, deg], received or sent: larger than any real arm's values
inline constexpr double kRsiMaxValue = 1e6;

enum class RsiErrorCode : std::uint8_t {
  kNone = 0,
  kTooLong,    ///< more than kRsiMaxDatagram bytes
  kMalformed,  ///< not well-formed XML, or truncated
  kWrongRoot,  ///< another element than Rob, or its Type is not KUKA
  kRepeated,   ///< a repeated element or attribute
  kMissing,    ///< a needed element is missing, or an attribute of any element
  kNumber,     ///< not a number, not finite, or out of the field's range
  kNoSpace,    ///< the caller's buffer is too small
};

/// Why and where a datagram was refused. Plain data, made in the tick.
struct RsiError {
  RsiErrorCode code{RsiErrorCode::kNone};
  RsiElement element{RsiElement::kNone};  ///< the element that was refused, if any
  std::uint8_t attribute{0};              ///< 1 … 6: A1 … A6, X … C, D; 0: none, or the element itself
  std::uint16_t byte{0};                  ///< where reading stopped

  [[nodiscard]] explicit operator bool() const { return code != RsiErrorCode::kNone; }
};

/// One line, e.g. "AIPos: attribute 4 is missing (byte 212)". Allocates, so not for the tick.
[[nodiscard]] std::string Describe(const RsiError& error);

/// Parses and checks a controller's message. Attributes and elements may come in any order; unknown ones are
/// skipped. Numbers are read with a decimal point, regardless of the process's locale. Every element present
/// must be complete (except EIPos).
/// @param needed  elements without which the message is refused, besides IPOC (RsiElement bits)
/// @returns code kNone if `message` was set; with any other code `message` is unchanged.
[[nodiscard]] RsiError DecodeRobot(std::span<const std::uint8_t> datagram, std::uint16_t needed,
                                   RsiRobotMessage& message) OSTEON_RT;

/// Writes an answer, byte for byte as documented in README.md: one space between attributes, double quotes,
/// no other white space, fixed decimals, never an exponent or a minus before zero.
/// @param number of decimals of the correction, 0 … 9
/// @returns kNone, with the datagram's length in `size`; kNumber if a value is not finite or beyond ±1e6, or
/// `decimals` is out of range; kNoSpace if the buffer is too small.
[[nodiscard]] RsiErrorCode EncodeAnswer(const RsiAnswer& answer, int decimals, std::span<std::uint8_t> buffer,
                                        std::size_t& size) OSTEON_RT;

/// Returns the number that EncodeAnswer writes for `value`: rounded to `decimals` decimals.
[[nodiscard]] double RsiRounded(double value, int decimals) OSTEON_RT;

}  // namespace osteon::io
