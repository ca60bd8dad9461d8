#pragma once

#include "kinematics/lbr_arm.h"
#include "safety/guard_monitor.h"
#include "tests/kinematics/iiwa14.h"

namespace osteon::safety {

/// A guard monitor between a controller and an arm that takes each passed command at once, in virtual time:
/// one message of the arm and one answer of the controller per millisecond.
class GuardBench {
 public:
  /// An iiwa 14 with a tool of 200 mm; its start is in the middle of a sphere, 100 mm above a plane.
  static GuardParams Params() {
    GuardParams params{.arm = kinematics::ChainFrom(kinematics::Iiwa14())};
    params.X_FT.translation() = Vector3(0.0, 0.0, 0.2);
    params.workspace.sphere_center_W_m = Start().translation();
    params.workspace.sphere_radius_m = 0.15;
    params.workspace.plane_offset_m = Start().translation().z() - 0.1;
    return params;
  }
  static GuardJoints StartJoints() { return {0.1, 0.6, -0.2, -1.3, 0.3, 0.9, -0.4}; }
  /// Tool pose, by kinematics that the guard does not use.
  static Pose ToolPose(const GuardJoints& q) {
    static const kinematics::LbrArm arm(kinematics::Iiwa14());
    Pose X_FT = Pose::Identity();
    X_FT.translation() = Vector3(0.0, 0.0, 0.2);
    return arm.FlangePose(Eigen::Map<const kinematics::JointVector>(q.data())) * X_FT;
  }
  static Pose Start() { return ToolPose(StartJoints()); }

  explicit GuardBench(const GuardParams& params = Params()) : monitor(params) {}

  /// Sends the arm's next message to the guard. @returns whether the guard passes it on
  GuardDecision Message(GuardSession session) {
    now += rt::kMillisecond;
    arm.session = session;
    ++arm.sequence;
    if (session >= GuardSession::kWaiting) arm.q_ipo = StartJoints();
    return monitor.OnArmMessage(arm, now);
  }
  /// Sends the controller's answer to the newest message, 0.3 ms later; a command that passes moves the arm.
  GuardDecision Answer(GuardCommand command) {
    command.sequence = ++sequence;
    command.reflected = arm.sequence;
    const GuardDecision decision = monitor.OnCommand(command, now + 300'000);
    if (decision == GuardDecision::kPass && arm.session == GuardSession::kActive) arm.q_meas = *command.q;
    return decision;
  }
  GuardDecision Answer(const GuardJoints& q) { return Answer(GuardCommand{.q = q}); }
  /// Runs until the arm is ready to follow. @returns whether every message and answer passed
  bool RunUntilArmFollows() {
    bool passes = true;
    for (int i = 0; i < 10; ++i) {
      passes &= Message(i < 5 ? GuardSession::kMonitoring : GuardSession::kWaiting) == GuardDecision::kPass;
      passes &= Answer(StartJoints()) == GuardDecision::kPass;
    }
    return passes;
  }

  GuardMonitor monitor;
  GuardArmMessage arm{.sequence = 4'000'000'000u, .q_meas = StartJoints()};  // large: near 2^32
  std::uint32_t sequence{0};
  rt::Nanoseconds now{rt::kSecond};
};

}  // namespace osteon::safety
