#pragma once

#include <cstdint>
#include <string>

#include "base/marker.h"

namespace osteon::safety {

/// Findings of the guard.
enum class GuardFinding : std::uint8_t {
  kNone = 0,
  kUnreadable,     ///< a datagram of the controller is not a command of the cell's FRI version
  kChecksum,       ///< a datagram of the controller has a CRC-32 that does not match its content
  kNeverSent,      ///< the command answers a message that the arm has not sent
  kSequence,       ///< the command's counter does not advance
  kNoPosition,     ///< the command has no joint position, although the arm is being commanded
  kCartesian,      ///< the command contains a Cartesian pose
  kNotFinite,      ///< a joint position, force or torque is not finite
  kNotMirrored,    ///< commanded position too far from the interpolator's position in COMMANDING_WAIT
  kJointPosition,  ///< beyond a joint's limits
  kJointSpeed,
  kToolSpeed,
  kToolTurn,
  kTracking,   ///< commanded apex too far from the measured one
  kWorkspace,  ///< apex beyond the sphere
  kPlane,      ///< apex beyond the plane
  kZone,       ///< apex, flange or elbow violates a zone; `joint` is the number of the zone, from 1
  kForce,      ///< force of the controller's added wrench beyond its limit
  kTorque,
  kJointTorque,  ///< added joint torque larger than any wrench within the limits needs
  kHandForce,    ///< hand force, estimated from the arm's external torques, beyond its limit
  kSilence,      ///< the controller was silent while the arm moved
};
inline constexpr int kGuardFindings = 22;

/// A finding, with the figures in SI.
struct GuardReason {
  GuardFinding finding{GuardFinding::kNone};
  int joint{0};  ///< 1 … 7 if the finding concerns a joint; see kZone
  double found{0.0};
  double min{0.0}, max{0.0};  ///< accepted range, if there is one
};

/// Returns the finding if `found` is outside 0 … `max` or NaN; kNone otherwise.
[[nodiscard]] inline GuardReason CheckAtMost(GuardFinding finding, double found, double max,
                                             int joint = 0) OSTEON_RT {
  if (found <= max) return {};
  return {.finding = finding, .joint = joint, .found = found, .max = max};
}

/// One line, e.g. "joint A4's speed: found 5.41 rad/s, accepted 0 … 1.31 rad/s". For screens and logs:
/// allocates.
[[nodiscard]] std::string Describe(const GuardReason& reason);

}  // namespace osteon::safety
