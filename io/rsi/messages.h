#pragma once

#include <array>
#include <cstdint>
#include <optional>

// RSI messages as plain data, in the wire's units: degrees and millimetres.

namespace osteon::io {

inline constexpr int kRsiAxes = 6;
/// A1 … A6 or E1 … E6 [deg]; for motor currents, per cent of the rated current.
using RsiAxes = std::array<double, kRsiAxes>;
/// X Y Z [mm], A B C [deg]: rotations about Z, then the new Y, then the new X.
using RsiFrame = std::array<double, 6>;

/// The elements of <Rob> that are read; others are skipped. Each value is one bit, so that a set of elements
/// fits in one number.
enum class RsiElement : std::uint16_t {
  kNone = 0,
  kRIst = 1u << 0,   ///< pose of the tool, measured
  kRSol = 1u << 1,   ///< pose of the tool, set point
  kAIPos = 1u << 2,  ///< axes, measured
  kASPos = 1u << 3,  ///< axes, set point
  kEIPos = 1u << 4,  ///< external axes, measured
  kMACur = 1u << 5,  ///< motor currents
  kDelay = 1u << 6,  ///< number of late answers
  kIpoc = 1u << 7,   ///< the message's number
};

/// The controller's message of each cycle: <Rob>. It contains only the elements that the controller's
/// Ethernet configuration names.
struct RsiRobotMessage {
  std::uint64_t ipoc{0};       ///< always there
  std::uint8_t ipoc_digits{};  ///< number of digits as received, with leading zeros: the answer has as many
  std::optional<std::uint32_t> delay;
  std::optional<RsiFrame> pose_measured, pose_set;  ///< RIst, RSol
  std::optional<RsiAxes> axes_measured, axes_set;   ///< AIPos, ASPos
  std::optional<RsiAxes> external_axes;             ///< EIPos; missing axes are 0
  std::optional<RsiAxes> motor_currents;            ///< MACur
};

/// The form of the answer <Sen> that the controller's Ethernet configuration expects.
enum class RsiLayout : std::uint8_t {
  kImFree,  ///< <Sen Type="ImFree">, correction, IPOC
  kKroshu,  ///< <Sen Type="KROSHU">, Stop, correction, IPOC: read by position, so exact to the byte
};

enum class RsiCorrection : std::uint8_t {
  kAxes,       ///< <AK A1 … A6> [deg]
  kCartesian,  ///< <RKorr X Y Z A B C> [mm, deg]
};

/// The PC's answer: <Sen>.
struct RsiAnswer {
  RsiLayout layout{RsiLayout::kImFree};
  RsiCorrection kind{RsiCorrection::kAxes};
  std::array<double, 6> correction{};
  bool stop{false};       ///< asks the controller to end RSI; only KROSHU's layout can express it
  std::uint64_t ipoc{0};  ///< IPOC of the message that is answered
  /// smallest number of IPOC digits, filled with leading zeros; 0: as many as needed
  std::uint8_t ipoc_digits{0};
};

/// Number of decimals of a correction that controllers with this layout are known to read.
[[nodiscard]] constexpr int RsiDecimals(RsiLayout layout) { return layout == RsiLayout::kImFree ? 4 : 6; }

}  // namespace osteon::io
