#include "safety/guard_monitor.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "base/number_text.h"
#include "safety/guard_zone.h"

namespace osteon::safety {
namespace {

constexpr std::uint32_t kMaxPeriods = 10;  // most periods between two commands that count for a speed
// a message counter that differs by more belongs to another session
constexpr std::int32_t kSessionStep = 64;
constexpr double kRest_rad_per_s = 1e-3;   // a commanded joint that is no faster counts as standing still
constexpr double kRest_N = 1e-3;           // a smaller added wrench or torque counts as zero
constexpr double kNormalTolerance = 1e-6;  // tolerance of the length of a direction
// Damping of the least squares for the hand's force. Because of it, the estimated force is too small near
// singular postures.
constexpr double kDamping = 1e-4;  // added to the diagonal of J J^T

// By how much the counter a is ahead of b, even if it has wrapped around; negative: a is behind.
std::int32_t Ahead(std::uint32_t a, std::uint32_t b) { return static_cast<std::int32_t>(a - b); }

// Whether the arm takes joint positions from the controller in this state.
bool Commanded(GuardSession session) { return session >= GuardSession::kWaiting; }

}  // namespace

GuardMonitor::GuardMonitor(const GuardParams& params)
    : params_(params), arm_(params.arm, params.X_WB, params.X_FT) {
  const auto require = [](bool accepted, const char* name, double found, const char* range) {
    if (!accepted || !std::isfinite(found))
      throw std::invalid_argument(std::string("guard: ") + name + ": found " + base::NumberText(found) +
                                  ", accepted " + range);
  };
  const auto positive = [&](const char* name, double value) { require(value > 0.0, name, value, "> 0"); };
  positive("period_s", params.period_s);
  positive("max_speed_m_per_s", params.max_speed_m_per_s);
  positive("max_turn_rad_per_s", params.max_turn_rad_per_s);
  positive("tolerance_rad", params.tolerance_rad);
  positive("max_start_path_speed_m_per_s", params.max_start_path_speed_m_per_s);
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
  const WorkspaceParams& workspace = params.workspace;
  positive("sphere_radius_m", workspace.sphere_radius_m);
  for (int i = 0; i < 3; ++i)
    require(true, "sphere_center_W_m", workspace.sphere_center_W_m[i], "finite numbers");
  const double normal = workspace.plane_normal_W.norm();
  require(std::abs(normal - 1.0) < kNormalTolerance, "plane_normal_W", normal, "a length of 1");
  require(true, "plane_offset_m", workspace.plane_offset_m, "finite numbers");
  require(workspace.zones.size() <= kMaxZones, "zones", static_cast<double>(workspace.zones.size()),
          "at most 16");
  for (const ZoneParams& zone : workspace.zones) RequireGuardZone(zone);
}

void GuardMonitor::Latch(const GuardReason& reason) OSTEON_RT {
  if (!latched()) reason_ = reason;
}

void GuardMonitor::ResetSession() OSTEON_RT {
  has_arm_ = answered_ = commanding_ = unanswered_ = false;
  unanswered_since_.reset();
  hand_force_messages_ = 0;
}

GuardDecision GuardMonitor::OnArmMessage(const GuardArmMessage& message, rt::Nanoseconds arrival) OSTEON_RT {
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
    been_in_zone_.fill(false);
    // zones that contain the arm at the hand-over are enforced from now on
    static_cast<void>(CheckPlacement(arm_.ComputePlacement(q_before_)));
    on_start_path_ = !AtStart(q_before_);
    rests_ = true;
  }
  arm_message_ = message;
  arm_arrival_ = arrival;
  has_arm_ = true;
  unanswered_ |= message.session != GuardSession::kIdle;
  CheckHandForce(message);
  return GuardDecision::kPass;
}

// Estimates the hand's force from the external torques on the joints, by damped least squares: J^T F = tau.
void GuardMonitor::CheckHandForce(const GuardArmMessage& message) OSTEON_RT {
  if (message.session != GuardSession::kActive || !message.tau_ext) {
    hand_force_messages_ = 0;
    return;
  }
  const Joints q = ToJoints(message.q_meas);
  const GuardKinematics::JointMotions motions =
      arm_.ComputeJointMotions(q, arm_.ComputePlacement(q).p_WFlange);
  Eigen::Matrix<double, 6, 7> J;
  for (std::size_t i = 0; i < GuardKinematics::kJoints; ++i)
    J.col(static_cast<Eigen::Index>(i)) << motions.v[i], motions.w[i];
  Eigen::Matrix<double, 6, 6> A = J * J.transpose();
  A.diagonal().array() += kDamping;
  const Eigen::Matrix<double, 6, 1> F = A.ldlt().solve(J * ToJoints(*message.tau_ext));
  const GuardReason reason = CheckAtMost(GuardFinding::kHandForce, F.head<3>().stableNorm(),
                                         (1.0 + params_.margin) * params_.max_hand_force_N);
  hand_force_messages_ = reason.finding == GuardFinding::kNone
                             ? 0
                             : std::min(hand_force_messages_ + 1, params_.hand_force_count);
  if (hand_force_messages_ == params_.hand_force_count) Latch(reason);
}

GuardDecision GuardMonitor::OnUnreadable(GuardFinding why) OSTEON_RT {
  Latch({.finding = why});
  ++counters_.withheld;
  return GuardDecision::kWithhold;
}

// Whether an answer is fresh. Counts a late or duplicate answer. Latches an answer to a message that was
// never sent, or with a counter that does not advance.
bool GuardMonitor::IsFresh(const GuardCommand& command, rt::Nanoseconds now) OSTEON_RT {
  if (!has_arm_ || arm_message_.session == GuardSession::kIdle) {
    ++counters_.late;
    return false;
  }
  const std::int32_t ago = Ahead(arm_message_.sequence, command.reflected);
  if (ago < 0) {
    Latch({.finding = GuardFinding::kNeverSent,
           .found = static_cast<double>(command.reflected),
           .max = static_cast<double>(arm_message_.sequence)});
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
           .min = static_cast<double>(command_sequence_)});
    return false;
  }
  return true;
}

GuardDecision GuardMonitor::OnCommand(const GuardCommand& command, rt::Nanoseconds now) OSTEON_RT {
  if (!latched()) {
    const bool fresh = IsFresh(command, now);
    if (!fresh && !latched()) return GuardDecision::kDrop;
    if (fresh) {
      const GuardReason reason = CheckCommand(command);
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

GuardReason GuardMonitor::CheckCommand(const GuardCommand& command) OSTEON_RT {
  if (const GuardReason reason = CheckOverlay(command); reason.finding != GuardFinding::kNone) return reason;
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
              CheckAtMost(GuardFinding::kNotMirrored, std::abs(q[i] - q_ipo[i]), params_.mirror_rad, i + 1);
          reason.finding != GuardFinding::kNone)
        return reason;
    rests_ = true;
    return {};
  }

  const std::uint32_t periods = std::clamp(command.reflected - before_message_, 1u, kMaxPeriods);
  const double time_s = periods * params_.period_s;
  if (const GuardReason reason = CheckJoints(q, time_s); reason.finding != GuardFinding::kNone) return reason;
  if (const GuardReason reason = CheckTool(q, time_s); reason.finding != GuardFinding::kNone) return reason;
  // whether the controller adds a force or torque to the motion
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

void GuardMonitor::CheckSilence(rt::Nanoseconds now) OSTEON_RT {
  // silence is measured from this check, not from the arm message's arrival: before the guard relayed the
  // message, the controller could not answer it
  if (unanswered_ && !unanswered_since_) unanswered_since_ = now;
  if (!commanding_ || !unanswered_since_) return;
  const double silent_s = rt::ToSeconds(now - *unanswered_since_);
  if (!(silent_s > params_.silence_s)) return;
  commanding_ = false;
  left_alone_ = true;
  if (!rests_) Latch({.finding = GuardFinding::kSilence, .found = silent_s, .max = params_.silence_s});
}

}  // namespace osteon::safety
