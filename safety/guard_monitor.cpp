#include "safety/guard_monitor.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace osteon::safety {
namespace {

using Joints = kinematics::JointVectorN<7>;

constexpr double kRounding = 1.0 + 1e-9;    // of differences between positions
constexpr std::uint32_t kMostPeriods = 10;  // between two commands, that a speed is taken over
constexpr std::int32_t kSessionStep = 64;   // a counter further away belongs to another session
constexpr double kRest_rad_per_s = 1e-3;    // slower than this the arm stands
constexpr double kRest_N = 1e-3;            // less than this is added: nothing
constexpr double kDamping = 1e-4;  // of the hand's force near singular postures, where it is underestimated

Joints ToJoints(const GuardJoints& q) { return Eigen::Map<const Joints>(q.data()); }

// 1 … 7: the first that is not finite; 0: all are.
int FirstNotFinite(const Joints& q) {
  for (int i = 0; i < 7; ++i)
    if (!std::isfinite(q[i])) return i + 1;
  return 0;
}

std::int32_t Ahead(std::uint32_t a, std::uint32_t b) { return static_cast<std::int32_t>(a - b); }

bool Commanded(GuardSession session) { return session >= GuardSession::kWaiting; }

GuardReason AtMost(GuardFinding finding, double found, double most, int joint = 0) {
  if (found <= most) return {};
  return {.finding = finding, .joint = joint, .found = found, .most = most};
}

}  // namespace

GuardMonitor::GuardMonitor(const GuardParams& params) : params_(params), arm_(params.arm) {
  const auto require = [](bool accepted, const char* name, double found, const char* range) {
    if (!accepted || !std::isfinite(found))
      throw std::invalid_argument(std::string("guard: ") + name + ": found " + std::to_string(found) +
                                  ", accepted " + range);
  };
  const auto positive = [&](const char* name, double value) { require(value > 0.0, name, value, "> 0"); };
  positive("period_s", params.period_s);
  positive("max_speed_m_per_s", params.max_speed_m_per_s);
  positive("max_turn_rad_per_s", params.max_turn_rad_per_s);
  positive("max_way_in_m_per_s", params.max_way_in_m_per_s);
  positive("max_tracking_error_m", params.max_tracking_error_m);
  positive("mirror_rad", params.mirror_rad);
  positive("max_force_N", params.max_force_N);
  positive("max_torque_Nm", params.max_torque_Nm);
  positive("max_hand_force_N", params.max_hand_force_N);
  positive("answer_age_s", params.answer_age_s);
  positive("silence_s", params.silence_s);
  require(params.joint_speed_share > 0.0 && params.joint_speed_share <= 1.0, "joint_speed_share",
          params.joint_speed_share, "0 … 1");
  require(params.margin >= 0.0 && params.margin <= 1.0, "margin", params.margin, "0 … 1");
  require(params.workspace_margin_m >= 0.0, "workspace_margin_m", params.workspace_margin_m, ">= 0");
  require(params.receive_multiplier >= 1, "receive_multiplier", params.receive_multiplier, ">= 1");
  require(params.hand_force_count >= 1, "hand_force_count", params.hand_force_count, ">= 1");
  for (const kinematics::RevoluteJoint& joint : params.arm.joints)
    positive("a joint's velocity limit", joint.limits.velocity_rad_per_s);
  static_cast<void>(Workspace(params.workspace));  // throws where its numbers are none
}

void GuardMonitor::Latch(const GuardReason& reason) OSTEON_RT {
  if (!latched()) reason_ = reason;
}

void GuardMonitor::StartOver() OSTEON_RT {
  has_arm_ = answered_ = commanding_ = unanswered_ = false;
  unanswered_since_.reset();
  hand_force_messages_ = 0;
}

GuardDecision GuardMonitor::Arm(const GuardArmMessage& message, rt::Nanoseconds arrival) OSTEON_RT {
  const std::int32_t step = Ahead(message.sequence, arm_message_.sequence);
  const bool restarted = step <= -kSessionStep && !Commanded(message.session);
  if (has_arm_ && step <= 0 && !restarted) {
    ++counters_.arm_dropped;
    return GuardDecision::kDrop;
  }
  const bool was_active = has_arm_ && arm_message_.session == GuardSession::kActive;
  const bool begins = message.session == GuardSession::kActive && (!was_active || step >= kSessionStep);
  if (restarted) answered_ = false;
  if (begins && message.q_ipo) {
    q_before_ = ToJoints(*message.q_ipo);
    before_message_ = message.sequence - 1;
    been_inside_ = false;
    rests_ = true;
  }
  arm_message_ = message;
  arm_arrival_ = arrival;
  has_arm_ = true;
  unanswered_ |= message.session != GuardSession::kIdle;
  TakeHandForce(message);
  return GuardDecision::kPass;
}

// The force that would put these torques on the joints, by damped least squares: J^T F = tau.
void GuardMonitor::TakeHandForce(const GuardArmMessage& message) OSTEON_RT {
  if (message.session != GuardSession::kActive || !message.tau_ext) {
    hand_force_messages_ = 0;
    return;
  }
  const kinematics::JacobianN<7> J = arm_.Jacobian(arm_.Place(ToJoints(message.q_meas)));
  Eigen::Matrix<double, 6, 6> A = J * J.transpose();
  A.diagonal().array() += kDamping;
  const Eigen::Matrix<double, 6, 1> F = A.ldlt().solve(J * ToJoints(*message.tau_ext));
  const GuardReason reason = AtMost(GuardFinding::kHandForce, F.head<3>().stableNorm(),
                                    (1.0 + params_.margin) * params_.max_hand_force_N);
  hand_force_messages_ = reason.finding == GuardFinding::kNone
                             ? 0
                             : std::min(hand_force_messages_ + 1, params_.hand_force_count);
  if (hand_force_messages_ == params_.hand_force_count) Latch(reason);
}

GuardDecision GuardMonitor::Unreadable(GuardFinding why) OSTEON_RT {
  Latch({.finding = why});
  ++counters_.withheld;
  return GuardDecision::kWithhold;
}

// Counts what is not; what the arm can not have asked for is latched.
bool GuardMonitor::IsFresh(const GuardCommand& command, rt::Nanoseconds now) OSTEON_RT {
  if (!has_arm_ || arm_message_.session == GuardSession::kIdle) {
    ++counters_.late;
    return false;
  }
  const std::int32_t ago = Ahead(arm_message_.sequence, command.reflected);
  if (ago < 0) {
    Latch({.finding = GuardFinding::kNeverSent,
           .found = static_cast<double>(command.reflected),
           .most = static_cast<double>(arm_message_.sequence)});
    return false;
  }
  if (answered_ && command.reflected == answered_message_) {
    ++counters_.duplicate;
    return false;
  }
  if (ago >= params_.receive_multiplier || rt::ToSeconds(now - arm_arrival_) > params_.answer_age_s ||
      (answered_ && Ahead(command.reflected, answered_message_) < 0)) {
    ++counters_.late;
    return false;
  }
  if (answered_ && commanding_ && Ahead(command.sequence, command_sequence_) <= 0) {
    Latch({.finding = GuardFinding::kSequence,
           .found = static_cast<double>(command.sequence),
           .least = static_cast<double>(command_sequence_)});
    return false;
  }
  return true;
}

GuardDecision GuardMonitor::Command(const GuardCommand& command, rt::Nanoseconds now) OSTEON_RT {
  if (!latched()) {
    const bool fresh = IsFresh(command, now);
    if (!fresh && !latched()) return GuardDecision::kDrop;
    if (fresh) {
      const GuardReason reason = Judge(command);
      if (reason.finding != GuardFinding::kNone) Latch(reason);
    }
  }
  if (latched()) {
    ++counters_.withheld;
    return GuardDecision::kWithhold;
  }
  answered_ = true;
  answered_message_ = command.reflected;
  command_sequence_ = command.sequence;
  commanding_ = Commanded(arm_message_.session);
  unanswered_ = false;
  unanswered_since_.reset();
  left_alone_ = false;
  ++counters_.passed;
  return GuardDecision::kPass;
}

GuardReason GuardMonitor::Judge(const GuardCommand& command) OSTEON_RT {
  if (const GuardReason reason = JudgeOverlay(command); reason.finding != GuardFinding::kNone) return reason;
  if (command.q) {
    const Joints q = ToJoints(*command.q);
    if (const int joint = FirstNotFinite(q); joint > 0)
      return {.finding = GuardFinding::kNotFinite, .joint = joint, .found = q[joint - 1]};
  }
  if (!Commanded(arm_message_.session)) return {};
  if (command.cartesian) return {.finding = GuardFinding::kCartesian};
  if (!command.q) return {.finding = GuardFinding::kNoPosition};
  const Joints q = ToJoints(*command.q);
  if (arm_message_.session == GuardSession::kWaiting) {
    const Joints q_ipo = ToJoints(arm_message_.q_ipo.value_or(arm_message_.q_meas));
    for (int i = 0; i < 7; ++i)
      if (const GuardReason reason =
              AtMost(GuardFinding::kNotMirrored, std::abs(q[i] - q_ipo[i]), params_.mirror_rad, i + 1);
          reason.finding != GuardFinding::kNone)
        return reason;
    rests_ = true;
    return {};
  }

  const std::uint32_t periods = std::clamp(command.reflected - before_message_, 1u, kMostPeriods);
  const double time_s = periods * params_.period_s;
  if (const GuardReason reason = JudgeJoints(q, time_s); reason.finding != GuardFinding::kNone) return reason;
  if (const GuardReason reason = JudgeTool(q, time_s); reason.finding != GuardFinding::kNone) return reason;
  const auto adds = [](const auto& values) {
    return values &&
           std::any_of(values->begin(), values->end(), [](double x) { return std::abs(x) > kRest_N; });
  };
  rests_ = (q - q_before_).cwiseAbs().maxCoeff() <= kRest_rad_per_s * time_s && !adds(command.wrench) &&
           !adds(command.tau);
  q_before_ = q;
  before_message_ = command.reflected;
  return {};
}

GuardReason GuardMonitor::JudgeJoints(const Joints& q, double time_s) const OSTEON_RT {
  const double share = std::min(1.0, params_.joint_speed_share * (1.0 + params_.margin)) * kRounding;
  for (int i = 0; i < 7; ++i) {
    if (q[i] == q_before_[i]) continue;
    const kinematics::JointLimits& limit = params_.arm.joints[static_cast<std::size_t>(i)].limits;
    if (!(q[i] >= limit.lower_rad && q[i] <= limit.upper_rad))
      return {.finding = GuardFinding::kJointPosition,
              .joint = i + 1,
              .found = q[i],
              .least = limit.lower_rad,
              .most = limit.upper_rad};
    if (const GuardReason reason = AtMost(GuardFinding::kJointSpeed, std::abs(q[i] - q_before_[i]) / time_s,
                                          share * limit.velocity_rad_per_s, i + 1);
        reason.finding != GuardFinding::kNone)
      return reason;
  }
  return {};
}

GuardReason GuardMonitor::JudgeTool(const Joints& q, double time_s) OSTEON_RT {
  const Pose X_WT = ToolPose(q);
  const Vector3 p_WT = X_WT.translation(), p_measured = ToolPose(ToJoints(arm_message_.q_meas)).translation();
  const double more = (1.0 + params_.margin) * kRounding;
  if (const GuardReason reason =
          AtMost(GuardFinding::kTracking, (p_WT - p_measured).norm(), more * params_.max_tracking_error_m);
      reason.finding != GuardFinding::kNone)
    return reason;

  // where it is: the sphere counts once the way from elsewhere has led into it
  const WorkspaceParams& w = params_.workspace;
  const double out_m = (p_WT - w.sphere_center_W_m).norm(),
               above_m = w.plane_normal_W.dot(p_WT) - w.plane_offset_m;
  const bool way_in = !been_inside_;
  been_inside_ |= out_m <= w.sphere_radius_m;
  if (q == q_before_) return {};
  if (!(above_m >= -params_.workspace_margin_m))
    return {.finding = GuardFinding::kPlane, .found = above_m, .least = -params_.workspace_margin_m};
  if (been_inside_)
    if (const GuardReason reason =
            AtMost(GuardFinding::kWorkspace, out_m, w.sphere_radius_m + params_.workspace_margin_m);
        reason.finding != GuardFinding::kNone)
      return reason;

  // how fast
  const Pose X_before = ToolPose(q_before_);
  const double most_m_per_s =
      way_in ? std::min(params_.max_way_in_m_per_s, params_.max_speed_m_per_s) : params_.max_speed_m_per_s;
  if (const GuardReason reason = AtMost(GuardFinding::kToolSpeed,
                                        (p_WT - X_before.translation()).norm() / time_s, more * most_m_per_s);
      reason.finding != GuardFinding::kNone)
    return reason;
  const double turn_rad = Eigen::AngleAxisd(X_before.linear().transpose() * X_WT.linear()).angle();
  return AtMost(GuardFinding::kToolTurn, turn_rad / time_s, more * params_.max_turn_rad_per_s);
}

GuardReason GuardMonitor::JudgeOverlay(const GuardCommand& command) const OSTEON_RT {
  if (command.wrench) {
    const Vector3 f = Eigen::Map<const Vector3>(command.wrench->data()),
                  t = Eigen::Map<const Vector3>(command.wrench->data() + 3);
    for (const double value : *command.wrench)
      if (!std::isfinite(value)) return {.finding = GuardFinding::kNotFinite, .found = value};
    if (const GuardReason reason =
            AtMost(GuardFinding::kForce, f.stableNorm(), kRounding * params_.max_force_N);
        reason.finding != GuardFinding::kNone)
      return reason;
    if (const GuardReason reason =
            AtMost(GuardFinding::kTorque, t.stableNorm(), kRounding * params_.max_torque_Nm);
        reason.finding != GuardFinding::kNone)
      return reason;
  }
  if (!command.tau) return {};
  const Joints tau = ToJoints(*command.tau);
  if (const int joint = FirstNotFinite(tau); joint > 0)
    return {.finding = GuardFinding::kNotFinite, .joint = joint, .found = tau[joint - 1]};
  const auto posture = arm_.Place(ToJoints(arm_message_.q_meas));
  const kinematics::JacobianN<7> J = arm_.JacobianAt(posture, posture.X_BF * params_.X_FT.translation());
  for (int i = 0; i < 7; ++i) {
    const double most_Nm =
        J.col(i).head<3>().norm() * params_.max_force_N + J.col(i).tail<3>().norm() * params_.max_torque_Nm;
    if (const GuardReason reason =
            AtMost(GuardFinding::kJointTorque, std::abs(tau[i]), kRounding * most_Nm, i + 1);
        reason.finding != GuardFinding::kNone)
      return reason;
  }
  return {};
}

void GuardMonitor::Look(rt::Nanoseconds now) OSTEON_RT {
  // from when it was looked at, not from when it arrived: what the guard kept waiting, nobody could answer
  if (unanswered_ && !unanswered_since_) unanswered_since_ = now;
  if (!commanding_ || !unanswered_since_) return;
  const double silent_s = rt::ToSeconds(now - *unanswered_since_);
  if (!(silent_s > params_.silence_s)) return;
  commanding_ = false;
  left_alone_ = true;
  if (!rests_) Latch({.finding = GuardFinding::kSilence, .found = silent_s, .most = params_.silence_s});
}

}  // namespace osteon::safety
