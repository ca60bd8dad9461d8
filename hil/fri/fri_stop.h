#pragma once

#include <cstdint>
#include <string>

namespace osteon::hil {

/// Why the arm ended commanding, did not begin it, or closed the session.
enum class StopReason : std::uint8_t {
  kNone,
  kQualityTimeout,  ///< the session closes
  kLostInARow,      ///< the arm holds; back to monitoring
  kLostPerSecond,   ///< the same
  /// The program asks for a command mode that the control mode does not offer; stays in monitoring.
  kControlMode,
  kEmergencyStop,  ///< this and the following are safety stops: the drives go off until it is acknowledged
  kNotMirrored,
  kCount,
  kNotFinite,
  kJointLimit,
  kJointStep,
  kAxisDelta,  ///< impedance control, commanded too far from the measured position: "illegal axis delta"
  kPowerOff,   ///< the drives lost their power, which a PLC switches
};

/// The reason of a stop, with its figures.
struct StopReport {
  StopReason reason{StopReason::kNone};
  std::uint32_t sequence{0};  ///< of the last monitoring message before the stop
  int joint{0};               ///< 1 … 7 if one joint is to blame, otherwise 0
  double found{0.0};          ///< rad, answers, values or a mode's number, by reason
  double accepted{0.0};       ///< the bound, in the same unit
};

/// Text for any arm whose drives have lost their power.
inline constexpr const char* kNoPower = "the drives have no power";

/// One line for a screen, e.g. "joint step: A4 moved 0.01200 rad in one command, accepted 0.00140".
[[nodiscard]] std::string Describe(const StopReport& stop);

}  // namespace osteon::hil
