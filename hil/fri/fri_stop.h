#pragma once

#include <cstdint>
#include <string>

namespace osteon::hil {

/// Reason why the arm ended commanding, did not begin it, or closed the session.
enum class StopReason : std::uint8_t {
  kNone,
  kQualityTimeout,  ///< the quality did not become GOOD in time: the session closes
  kLostInARow,  ///< too many consecutive answers lost: the arm holds its position and returns to monitoring
  kLostPerSecond,  ///< too many answers lost in a second: the arm reacts in the same way
  /// The program requests a command mode that the present control mode does not allow: the arm stays in
  /// monitoring.
  kControlMode,
  kEmergencyStop,  ///< this and the following reasons are safety stops: the drives stay off until the stop is
                   ///< acknowledged
  kNotMirrored,
  kCount,
  kNotFinite,
  kJointLimit,
  kJointStep,
  kAxisDelta,  ///< impedance control, commanded too far from the measured position: "illegal axis delta"
  kPowerOff,   ///< a PLC switched off the drives' power
};

/// The reason of a stop, with the numbers that explain it.
struct StopReport {
  StopReason reason{StopReason::kNone};
  std::uint32_t sequence{0};  ///< sequence number of the last monitoring message before the stop
  int joint{0};               ///< 1 … 7 if one joint caused the stop, otherwise 0
  /// Found value; by reason an angle [rad], a number of answers or values, or a mode's number.
  double found{0.0};
  double accepted{0.0};  ///< accepted value, in the same unit
};

/// Text for any arm whose drives have lost their power.
inline constexpr const char* kNoPower = "the drives have no power";

/// One line for a screen, e.g. "joint step: A4 moved 0.01200 rad in one command, accepted 0.00140".
[[nodiscard]] std::string Describe(const StopReport& stop);

}  // namespace osteon::hil
