#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include <tl/expected.hpp>

// The controller's side of RSI's XML: writes <Rob>, reads <Sen>. Written independently of io/rsi, from the
// same table, so that the two check each other. Uses fmt to write and a parser by position to read; allocates
// memory.

namespace osteon::hil {

enum class RsiFormat : std::uint8_t {
  kImFree,  ///< the elements of <Sen> may have any order; unknown elements are skipped
  kKroshu,  ///< <Sen> is read by position and refused if any byte differs from the format
};

using Six = std::array<double, 6>;  ///< values of six axes, or of a frame X Y Z A B C

/// Content of the controller's message <Rob>. Degrees and millimetres.
struct RobMessage {
  RsiFormat format{RsiFormat::kImFree};
  Six pose_measured{}, pose_set{};  ///< X Y Z A B C; pose_set is sent only in kImFree
  Six axes_measured{}, axes_set{};  ///< A1 … A6; axes_set is sent only in kImFree
  Six external{};                   ///< E1 … E6
  Six currents{};                   ///< A1 … A6 [%]; only in kImFree
  std::uint32_t delay{0};
  std::uint64_t ipoc{0};
};

[[nodiscard]] std::string WriteRob(const RobMessage& message);

/// Content of the PC's answer <Sen>.
struct SenMessage {
  bool stop{false};
  Six correction{};  ///< the six values of AK or RKorr, whichever is expected
  std::uint64_t ipoc{0};
};

/// @param cartesian  true: <RKorr> is expected, otherwise <AK>
/// @returns the message, or an error text that says what was expected at which byte.
[[nodiscard]] tl::expected<SenMessage, std::string> ReadSen(std::span<const std::uint8_t> datagram,
                                                            RsiFormat format, bool cartesian);

}  // namespace osteon::hil
