#include "safety/guard_reason.h"

#include <fmt/format.h>

namespace osteon::safety {
namespace {

// Makes a text "what: found 5.41 unit, accepted 0 … 1.31 unit". @param scale  factor from SI to the unit
std::string Figures(const char* what, const GuardReason& r, double scale, const char* unit) {
  return fmt::format("{}: found {:.6g} {}, accepted {:.6g} … {:.6g} {}", what, scale * r.found, unit,
                     scale * r.min, scale * r.max, unit);
}

// The same text for a quantity, in SI, of the joint that the finding concerns.
std::string OfJoint(const char* what, const GuardReason& r, const char* unit) {
  return Figures(fmt::format("joint A{}'s {}", r.joint, what).c_str(), r, 1.0, unit);
}

}  // namespace

std::string Describe(const GuardReason& r) {
  switch (r.finding) {
    case GuardFinding::kNone:
      return "nothing";
    case GuardFinding::kUnreadable:
      return "the controller's datagram: found no command of the cell's FRI version, accepted one";
    case GuardFinding::kChecksum:
      return "the controller's datagram: found another CRC-32 than its message's, accepted the same";
    case GuardFinding::kNeverSent:
      return fmt::format(
          "the message answered: found number {:.0f}, accepted at most {:.0f}, the arm's newest", r.found,
          r.max);
    case GuardFinding::kSequence:
      return fmt::format("the controller's counter: found {:.0f}, accepted more than {:.0f}", r.found, r.min);
    case GuardFinding::kNoPosition:
      return "the command: found no joint position, accepted one while the arm is commanded";
    case GuardFinding::kCartesian:
      return "the command: found a Cartesian pose, accepted joint positions";
    case GuardFinding::kNotFinite:
      return r.joint > 0 ? fmt::format("joint A{}: found {}, accepted finite numbers", r.joint, r.found)
                         : fmt::format("the wrench: found {}, accepted finite numbers", r.found);
    case GuardFinding::kNotMirrored:
      return OfJoint("distance from where the waiting arm is", r, "rad");
    case GuardFinding::kJointPosition:
      return OfJoint("position", r, "rad");
    case GuardFinding::kJointSpeed:
      return OfJoint("speed", r, "rad/s");
    case GuardFinding::kToolSpeed:
      return Figures("tool speed", r, 1e3, "mm/s");
    case GuardFinding::kToolTurn:
      return Figures("tool's turn", r, 1.0, "rad/s");
    case GuardFinding::kTracking:
      return Figures("commanded apex from measured apex", r, 1e3, "mm");
    case GuardFinding::kWorkspace:
      return Figures("apex from the centre of the workspace", r, 1e3, "mm");
    case GuardFinding::kPlane:
      return fmt::format("apex above the workspace's plane: found {:.6g} mm, accepted at least {:.6g} mm",
                         1e3 * r.found, 1e3 * r.min);
    case GuardFinding::kZone:
      return fmt::format("inside of zone {}: found {:.6g} mm, accepted at least {:.6g} mm", r.joint,
                         1e3 * r.found, 1e3 * r.min);
    case GuardFinding::kForce:
      return Figures("force added", r, 1.0, "N");
    case GuardFinding::kTorque:
      return Figures("torque added", r, 1.0, "N·m");
    case GuardFinding::kJointTorque:
      return OfJoint("torque added", r, "N·m");
    case GuardFinding::kHandForce:
      return Figures("force from outside, by the arm's torques", r, 1.0, "N");
    case GuardFinding::kSilence:
      return Figures("silence of the controller while the arm moved", r, 1e3, "ms");
  }
  return "unknown";
}

}  // namespace osteon::safety
