// ServoLoop's joints: how they follow the tool, where the elbow goes, and how a stop brings them to rest.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "control/servo_loop.h"
#include "control/twist_parts.h"

namespace osteon::control {
namespace {

using kinematics::JointVector;
using safety::Fault;

constexpr double kElbowRate_per_s = 40.0;  // toward the wanted arm angle, where it is near
constexpr double kElbowThere_rad = 1e-6;
constexpr double kMoving_m_per_s = 0.02,
                 kMoving_rad_per_s = 0.1;  // of the tool: the elbow has its full speed
constexpr double kStands = 1e-6;           // of that: rounding
constexpr double kRest_m_per_s = 1e-9, kRest_rad_per_s = 1e-9;

double WrapAngle(double angle) { return std::remainder(angle, 2.0 * std::numbers::pi); }

}  // namespace

// Moves the joints so that the tool has a velocity, as far as they may in a tick, and the virtual tool where
// the arm then is. False, with the fault latched and nothing moved, where that is not known.
bool ServoLoop::Follow(const Twist& V_WT, bool& limited) OSTEON_RT {
  const double dt_s = params_.period_s;
  const Twist V_BT = Turned(X_BW_.linear(), V_WT);
  kinematics::MotionInput<7> wanted;
  wanted.J = arm_.JacobianAt(q_, X_FT_.translation());
  wanted.V_BT = V_BT;
  wanted.q = q_;
  wanted.qd_before = q_step_ / dt_s;
  wanted.share_before = motion_share_;
  wanted.qd_null = WantedElbow(V_WT);
  wanted.dt_s = dt_s;
  const kinematics::MotionOutput<7> moves = motion_.Step(wanted);
  if (!moves.finite) {
    faults_.Latch(Fault::kInverseKinematics);
    return false;
  }
  // what was just limited is checked by what knows nothing of it
  const safety::JointGuard::Result guard = joint_guard_.Limit(q_, dt_s * moves.qd, dt_s);
  if (guard.jump || guard.violated) {
    faults_.Latch(Fault::kJointLimit);
    return false;
  }
  motion_share_ = moves.share;
  moving_ = std::min(1.0, moves.V_BT.v.norm() / kMoving_m_per_s + moves.V_BT.w.norm() / kMoving_rad_per_s);
  if (moving_ < kStands) moving_ = 0.0;
  sigma_min_m_ = moves.sigma_min_m;
  sigma_gradient_m_ = moves.sigma_gradient_m;
  null_direction_ = moves.null_direction;
  limited = moves.limit != kinematics::MotionLimit::kNone || guard.share < 1.0;
  q_step_ = guard.step;
  q_ += q_step_;
  X_WT_ = ToolPose(q_);
  if (limited) {
    // the law goes on from what the tool does; as the model's age fades the motion, so its reaction
    const Twist V_done_WT = Turned(X_WB_.linear(), Scaled(moves.V_BT, guard.share));
    V_WT_.v += share_ * (V_done_WT.v - V_WT.v);
    V_WT_.w += share_ * (V_done_WT.w - V_WT.w);
  }
  return true;
}

// Where the joints should go for the elbow's sake, as a velocity whose part in the null space counts.
kinematics::JointVector ServoLoop::WantedElbow(const Twist& V_WT) OSTEON_RT {
  const double dt_s = params_.period_s;
  // what limits will leave of the twist, by the tick before: an elbow held for a tool that can't move would
  // move
  const Twist V_likely_WT = Scaled(V_WT, motion_share_);

  // the arm angle: held, and turned to the wanted one
  const double arm_angle_rad = arm_.ArmAngle(q_);
  const double error_rad = WrapAngle(wanted_arm_angle_rad_ - arm_angle_rad);
  elbow_arrived_ |= std::abs(error_rad) < kElbowThere_rad;
  const double most = params_.arm_angle_rate_rad_per_s;
  const double share = phase_ != Phase::kHaptic ? 0.0 : elbow_arrived_ ? moving_ : share_;
  kinematics::LoadPreference<7> load;
  if (body_ && (share > 0.0 || moving_ > 0.0))
    load = kinematics::TowardsLoad<7>(params_.posture, *body_, wanted_load_, q_, null_direction_);
  // an angle at which the arm does not hold the load is not worth holding
  const double worth = 1.0 - load.depth * load.depth;
  const double turn = worth * share * std::clamp(kElbowRate_per_s * error_rad, -most, most);
  JointVector qd = JointVector::Zero(), q_there;
  if (turn == 0.0 && V_likely_WT.v.isZero(0.0) && V_likely_WT.w.isZero(0.0))
    return qd;  // not by rounding either
  if (arm_.Inverse(X_BW_ * Move(X_WT_, V_likely_WT, dt_s) * X_TF_, arm_angle_rad + dt_s * turn, q_,
                   q_there) &&
      (q_there - q_).cwiseAbs().maxCoeff() < params_.joints.jump_rad)
    qd = (q_there - q_) / dt_s;

  qd += moving_ * kinematics::AwayFromLimits<7>(params_.posture, params_.joints.limits,
                                                params_.joints.position_margin_rad, q_);
  qd += moving_ * kinematics::AwayFromSingularity<7>(params_.posture, sigma_min_m_, sigma_gradient_m_);
  qd += moving_ * load.qd;
  return qd;
}

void ServoLoop::Brake() OSTEON_RT {
  if (joint_stop_ticks_ > 0) {
    BrakeJoints();
    return;
  }
  // the whole twist by one factor: the longer of the two halves' braking times counts
  const double dt_s = params_.period_s;
  const double time_s = std::max(V_WT_.v.norm() / params_.stop_deceleration_m_per_s2,
                                 V_WT_.w.norm() / params_.stop_deceleration_rad_per_s2);
  V_WT_ = Scaled(V_WT_, time_s > dt_s ? 1.0 - dt_s / time_s : 0.0);
  if (V_WT_.v.norm() < kRest_m_per_s && V_WT_.w.norm() < kRest_rad_per_s) {
    V_WT_ = {};
    q_step_.setZero();
    phase_ = Phase::kStopped;
    return;
  }
  bool limited = false;
  if (!Follow(V_WT_, limited)) BrakeJoints();
}

void ServoLoop::BrakeJoints() OSTEON_RT {
  if (joint_stop_ticks_ == 0)
    joint_stop_ticks_ = std::max(1, static_cast<int>(std::ceil(params_.joint_stop_s / params_.period_s)));
  --joint_stop_ticks_;
  q_step_ *= static_cast<double>(joint_stop_ticks_) / (joint_stop_ticks_ + 1);
  const safety::JointGuard::Result guard = joint_guard_.Limit(q_, q_step_, params_.period_s);
  q_step_ = guard.step;
  q_ += q_step_;
  const Vector3 p_before = X_WT_.translation();
  X_WT_ = ToolPose(q_);
  V_WT_ = {.v = (X_WT_.translation() - p_before) / params_.period_s, .w = Vector3::Zero()};
  if (joint_stop_ticks_ > 0) return;
  V_WT_ = {};
  phase_ = Phase::kStopped;
}

}  // namespace osteon::control
