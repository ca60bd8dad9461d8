#pragma once

#include <cstdint>

#include "base/marker.h"

// The client's side of CiA 402's state machine of a drive: decodes the state from the statusword (6041), and
// computes the controlword (6040).

namespace osteon::io {

enum class DriveState : std::uint8_t {
  kNotReady,
  kDisabled,  ///< switch on disabled
  kReady,     ///< ready to switch on
  kSwitchedOn,
  kEnabled,  ///< operation enabled: the motor is controlled
  kQuickStop,
  kFaultReaction,
  kFault,
  kUnknown,  ///< a statusword that matches no state
};

/// The state that the client wants the drive to reach.
enum class DriveGoal : std::uint8_t {
  kOff,        ///< no torque
  kEnabled,    ///< turning at the commanded speed
  kQuickStop,  ///< brakes to rest with its quick-stop deceleration, then stays at rest under torque
};

/// Controlwords.
inline constexpr std::uint16_t kControlDisableVoltage = 0x00, kControlShutdown = 0x06,
                               kControlSwitchOn = 0x07, kControlEnable = 0x0F, kControlQuickStop = 0x02,
                               kControlFaultReset = 0x80;

/// The state in a statusword: mask 0x6F for ready, switched on, enabled and quick stop, 0x4F for the others.
[[nodiscard]] DriveState StateOf(std::uint16_t statusword) OSTEON_RT;

/// The controlword that leads from `state` one step toward `goal`:
///
///     to enabled      disabled ─06─▶ ready ─07─▶ switched on ─0F─▶ enabled
///     to quick stop   enabled ─02─▶ quick stop; a drive that is not enabled is switched off (00)
///     to off          00, from anywhere
///
/// Quick stop ends only with goal off, so a stopped drive never starts by itself. A fault needs a reset
/// (rising edge of bit 7, 0x80), which this function never commands.
[[nodiscard]] std::uint16_t ControlToward(DriveGoal goal, DriveState state) OSTEON_RT;

/// Returns the state's name, e.g. "switch on disabled". Not for use in the tick.
[[nodiscard]] const char* Describe(DriveState state);

}  // namespace osteon::io
