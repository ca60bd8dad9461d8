#include "io/can/cia402.h"

namespace osteon::io {

DriveState StateOf(std::uint16_t statusword) OSTEON_RT {
  switch (statusword & 0x6F) {
    case 0x21:
      return DriveState::kReady;
    case 0x23:
      return DriveState::kSwitchedOn;
    case 0x27:
      return DriveState::kEnabled;
    case 0x07:
      return DriveState::kQuickStop;
    default:
      break;
  }
  switch (statusword & 0x4F) {
    case 0x00:
      return DriveState::kNotReady;
    case 0x40:
      return DriveState::kDisabled;
    case 0x0F:
      return DriveState::kFaultReaction;
    case 0x08:
      return DriveState::kFault;
    default:
      return DriveState::kUnknown;
  }
}

std::uint16_t ControlToward(DriveGoal goal, DriveState state) OSTEON_RT {
  if (goal == DriveGoal::kEnabled) {
    switch (state) {
      case DriveState::kDisabled:
        return kControlShutdown;
      case DriveState::kReady:
        return kControlSwitchOn;
      case DriveState::kSwitchedOn:
      case DriveState::kEnabled:
        return kControlEnable;
      default:
        return kControlDisableVoltage;
    }
  }
  if (goal == DriveGoal::kQuickStop && (state == DriveState::kEnabled || state == DriveState::kQuickStop))
    return kControlQuickStop;
  return kControlDisableVoltage;
}

const char* Describe(DriveState state) {
  switch (state) {
    case DriveState::kNotReady:
      return "not ready to switch on";
    case DriveState::kDisabled:
      return "switch on disabled";
    case DriveState::kReady:
      return "ready to switch on";
    case DriveState::kSwitchedOn:
      return "switched on";
    case DriveState::kEnabled:
      return "operation enabled";
    case DriveState::kQuickStop:
      return "quick stop active";
    case DriveState::kFaultReaction:
      return "fault reaction active";
    case DriveState::kFault:
      return "fault";
    case DriveState::kUnknown:
      break;
  }
  return "unknown";
}

}  // namespace osteon::io
