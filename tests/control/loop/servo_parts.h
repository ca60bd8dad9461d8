#pragma once

#include <memory>

#include "control/arm/arm_follower.h"
#include "control/ports.h"
#include "control/setup/servo_params.h"
#include "tests/control/loop/servo_bench.h"

// Shared by the tests of the servo loop's parts: a message of ServoBench's arm, a follower for this arm, and
// a bone.

namespace osteon::control {

/// A message of an arm that stands at the bench's start pose.
inline ArmState StandingArm(SessionState session = SessionState::kCommandingActive) {
  ArmState state;
  Eigen::Map<kinematics::JointVector>(state.q_meas.data()) = ServoBench::StartJoints();
  state.q_ipo = state.q_meas;
  state.has_ipo = true;
  state.session = session;
  return state;
}

/// A follower of the bench's arm, reset to the start pose.
inline std::unique_ptr<ArmFollower> Follower(const ServoParams& params) {
  auto arm = MakeFollower(params, ServoBench::Arm(), Pose::Identity(), ServoBench::FlangeToTool(),
                          ServoBench::Arm().ArmAngle(ServoBench::StartJoints()));
  arm->ResetTo(StandingArm().q_meas);
  arm->StartFollowing();
  return arm;
}

/// A plane across the tool's feed, `depth_m` behind the apex of the start pose. A tool at the start pose is
/// thus `depth_m` deep in bone.
inline simulation::ContactModel PlaneBehind(double depth_m, rt::Nanoseconds now) {
  const Pose X_WT = ServoBench::StartPose();
  const Vector3 feed_W = X_WT.linear().col(2);
  simulation::ContactModel model;
  model.frame = 1;
  model.pose_stamp = now;
  model.X_WP = X_WT;
  model.contact_count = 1;
  model.contacts[0].p_W_m = Vector3(X_WT.translation() - depth_m * feed_W);
  model.contacts[0].n_W = Vector3(-feed_W);
  model.contacts[0].stiffness_N_per_m = 20e3;
  return model;
}

}  // namespace osteon::control
