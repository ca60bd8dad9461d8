#include "hil/fri/fri_stop.h"

#include <fmt/format.h>

namespace osteon::hil {
namespace {

// Name of a control mode, given its number as stored in StopReport::found and accepted.
const char* ModeName(double mode) {
  return mode < 0.5 ? "POSITION" : mode < 1.5 ? "CARTESIAN_IMPEDANCE" : mode < 2.5 ? "JOINT_IMPEDANCE" : "NO";
}

}  // namespace

std::string Describe(const StopReport& stop) {
  switch (stop.reason) {
    case StopReason::kNone:
      return "none";
    case StopReason::kQualityTimeout:
      return fmt::format("timeout before quality GOOD: session closed after {:g} s", stop.accepted);
    case StopReason::kLostInARow:
      return fmt::format("{:g} answers in a row lost, the arm ends commanding at {:g}", stop.found,
                         stop.accepted);
    case StopReason::kLostPerSecond:
      return fmt::format("{:g} answers lost within a second, the arm ends commanding at {:g}", stop.found,
                         stop.accepted);
    case StopReason::kControlMode:
      return fmt::format("control mode: {} control, the program's command mode needs {} control",
                         ModeName(stop.found), ModeName(stop.accepted));
    case StopReason::kEmergencyStop:
      return fmt::format("emergency stop, level {:g}", stop.found);
    case StopReason::kNotMirrored:
      return fmt::format(
          "not mirrored: A{} commanded {:.4f} rad off the interpolator before the motion began, accepted "
          "{:.4f}",
          stop.joint, stop.found, stop.accepted);
    case StopReason::kCount:
      return fmt::format(
          "count: {:g} values of a joint position, torque or wrench in a command, accepted {:g}", stop.found,
          stop.accepted);
    case StopReason::kNotFinite:
      return stop.joint > 0 ? fmt::format("not finite: A{} commanded {}", stop.joint, stop.found)
                            : fmt::format("not finite: wrench commanded {}", stop.found);
    case StopReason::kJointLimit:
      return fmt::format("joint limit: A{} commanded {:.4f} rad, accepted at {} {:.4f}", stop.joint,
                         stop.found, stop.found > stop.accepted ? "most" : "least", stop.accepted);
    case StopReason::kJointStep:
      return fmt::format("joint step: A{} moved {:.5f} rad in one command, accepted {:.5f}", stop.joint,
                         stop.found, stop.accepted);
    case StopReason::kAxisDelta:
      return fmt::format("illegal axis delta: A{} commanded {:.4f} rad from where it is, accepted {:.4f}",
                         stop.joint, stop.found, stop.accepted);
    case StopReason::kPowerOff:
      return kNoPower;
  }
  return "unknown";
}

}  // namespace osteon::hil
