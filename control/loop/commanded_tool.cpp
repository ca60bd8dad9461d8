#include "control/loop/commanded_tool.h"

#include <algorithm>
#include <utility>

namespace osteon::control {
namespace {

// at a smaller speed, a braked tool is at rest
constexpr double kRest_m_per_s = 1e-9, kRest_rad_per_s = 1e-9;

}  // namespace

CommandedTool::CommandedTool(const ServoParams& params, std::unique_ptr<ArmFollower> arm)
    : params_(params), arm_(std::move(arm)), workspace_(WorkspaceOf(params)) {}

void CommandedTool::ResetToArmPose(const ArmState& state) OSTEON_RT {
  HoldStill();
  if (state.session == SessionState::kIdle) return;
  arm_->ResetTo(state.has_ipo ? state.q_ipo : state.q_meas);
  has_pose_ = true;
}

void CommandedTool::HoldStill() OSTEON_RT {
  V_WT = {};
  fade = 0.0;
  arm_->StopJoints();
}

void CommandedTool::StartBraking() OSTEON_RT {
  V_WT = Velocity();
  fade = 1.0;
}

FollowedTwist CommandedTool::FollowTwist(double max_elbow_speed_m_per_s, bool elbow_moves) OSTEON_RT {
  const Twist V_asked_WT = Velocity();
  const MotionResult followed = arm_->Follow({.V_WT = V_asked_WT,
                                              .elbow_scale = fade,
                                              .max_elbow_speed_m_per_s = max_elbow_speed_m_per_s,
                                              .elbow_moves = elbow_moves});
  if (followed.fault != safety::Fault::kNone) return {.fault = followed.fault};
  if (followed.limited || followed.zone_acted || followed.elbow_acted) {
    // The law continues from the motion that the arm has made. The correction is multiplied by the fade, like
    // the motion.
    V_WT.v += fade * (followed.V_WT.v - V_asked_WT.v);
    V_WT.w += fade * (followed.V_WT.w - V_asked_WT.w);
  }
  FollowedTwist result{.joints_limited = followed.limited};
  result.acting.Add(safety::Limit::kZones, followed.zone_acted);
  result.acting.Add(safety::Limit::kElbowSpeed, followed.elbow_acted);
  return result;
}

BrakingStep CommandedTool::Brake(double max_elbow_speed_m_per_s) OSTEON_RT {
  if (arm_->braking_joints()) return {.at_rest = BrakeJoints()};
  // The whole twist is scaled by one factor. The braking time is the longer one of translation and rotation.
  const double dt_s = params_.period_s;
  const double time_s = std::max(V_WT.v.norm() / params_.stop_deceleration_m_per_s2,
                                 V_WT.w.norm() / params_.stop_deceleration_rad_per_s2);
  V_WT = Scaled(V_WT, time_s > dt_s ? 1.0 - dt_s / time_s : 0.0);
  // If the rotation needs longer to stop than the translation, the apex brakes more slowly: it must still
  // stop before its bound.
  V_WT.v = workspace_.Limit(X_WT().translation(), V_WT.v, dt_s).v_WT;
  if (V_WT.v.norm() < kRest_m_per_s && V_WT.w.norm() < kRest_rad_per_s) return {.at_rest = true};
  const FollowedTwist followed = FollowTwist(max_elbow_speed_m_per_s, false);
  BrakingStep step{.fault = followed.fault, .acting = followed.acting};
  if (step.fault != safety::Fault::kNone) step.at_rest = BrakeJoints();
  return step;
}

bool CommandedTool::BrakeJoints() OSTEON_RT {
  const Vector3 p_before_W = X_WT().translation();
  const bool rests = arm_->BrakeJoints();
  V_WT = {.v = (X_WT().translation() - p_before_W) / params_.period_s, .w = Vector3::Zero()};
  return rests;
}

}  // namespace osteon::control
