#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include <tl/expected.hpp>

// The controller's side of RSI's XML: <Rob> out, <Sen> in. Written independently of io/rsi, from the same
// table, so that the two check each other. Text with fmt, a reader that parses by position; allocates.

namespace osteon::hil {

enum class RsiFormat : std::uint8_t {
  kImFree,  ///< elements of <Sen> in any order, unknown ones skipped
  kKroshu,  ///< <Sen> read by position: refused if a single byte is off
};

using Six = std::array<double, 6>;  ///< of six axes, or of a frame X Y Z A B C

/// <Rob>. Degrees and millimetres.
struct RobMessage {
  RsiFormat format{RsiFormat::kImFree};
  Six pose_measured{}, pose_set{};  ///< X Y Z A B C; set: only in kImFree
  Six axes_measured{}, axes_set{};  ///< A1 … A6; set: only in kImFree
  Six external{};                   ///< E1 … E6
  Six currents{};                   ///< A1 … A6 [%]; only in kImFree
  std::uint32_t delay{0};
  std::uint64_t ipoc{0};
};

[[nodiscard]] std::string WriteRob(const RobMessage& message);

/// <Sen>.
struct SenMessage {
  bool stop{false};
  Six correction{};  ///< of AK or RKorr, as expected
  std::uint64_t ipoc{0};
};

/// @param cartesian  expects <RKorr>, otherwise <AK>
/// @returns the message, or what was expected at which byte.
[[nodiscard]] tl::expected<SenMessage, std::string> ReadSen(std::span<const std::uint8_t> datagram,
                                                            RsiFormat format, bool cartesian);

}  // namespace osteon::hil
