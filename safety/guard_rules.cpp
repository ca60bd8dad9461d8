// GuardMonitor's checks of a single command: joints, tool, and the wrench or torques added to the motion.

#include <algorithm>
#include <cmath>

#include "safety/guard_monitor.h"
#include "safety/guard_zone.h"

namespace osteon::safety {
namespace {

constexpr double kRounding = 1.0 + 1e-9;  // tolerance of differences between positions

}  // namespace

GuardReason GuardMonitor::CheckJoints(const Joints& q, double time_s) const OSTEON_RT {
  // usable share of the velocity limits
  const double share = std::min(1.0, params_.joint_speed_share * (1.0 + params_.margin)) * kRounding;
  for (int i = 0; i < 7; ++i) {
    if (q[i] == q_before_[i]) continue;
    const kinematics::JointLimits& limit = params_.arm.joints[static_cast<std::size_t>(i)].limits;
    if (!(q[i] >= limit.lower_rad && q[i] <= limit.upper_rad))
      return {.finding = GuardFinding::kJointPosition,
              .joint = i + 1,
              .found = q[i],
              .min = limit.lower_rad,
              .max = limit.upper_rad};
    if (const GuardReason reason =
            CheckAtMost(GuardFinding::kJointSpeed, std::abs(q[i] - q_before_[i]) / time_s,
                        share * limit.velocity_rad_per_s, i + 1);
        reason.finding != GuardFinding::kNone)
      return reason;
  }
  return {};
}

GuardReason GuardMonitor::CheckTool(const Joints& q, double time_s) OSTEON_RT {
  const GuardKinematics::Placement arm = arm_.ComputePlacement(q);
  const Vector3 &p_WT = arm.p_WT, p_measured = arm_.ComputePlacement(ToJoints(arm_message_.q_meas)).p_WT;
  const double with_margin = (1.0 + params_.margin) * kRounding;
  if (const GuardReason reason = CheckAtMost(GuardFinding::kTracking, (p_WT - p_measured).norm(),
                                             with_margin * params_.max_tracking_error_m);
      reason.finding != GuardFinding::kNone)
    return reason;

  // CheckPlacement also records which zones the arm is in, so call it for every command. A command that
  // repeats the last position is accepted anywhere.
  const GuardReason place = CheckPlacement(arm);
  if (q == q_before_) return {};
  if (place.finding != GuardFinding::kNone) return place;

  // speed
  if (arm_message_.compliant && Relaxes(q)) return {};
  const GuardKinematics::Placement before = arm_.ComputePlacement(q_before_);
  on_start_path_ &= !AtStart(q_before_);
  const double max_speed_m_per_s =
      on_start_path_ ? std::max(params_.max_start_path_speed_m_per_s, params_.max_speed_m_per_s)
                     : params_.max_speed_m_per_s;
  if (const GuardReason reason = CheckAtMost(GuardFinding::kToolSpeed, (p_WT - before.p_WT).norm() / time_s,
                                             with_margin * max_speed_m_per_s);
      reason.finding != GuardFinding::kNone)
    return reason;
  const double turn_rad = Eigen::AngleAxisd(before.R_WT.transpose() * arm.R_WT).angle();
  return CheckAtMost(GuardFinding::kToolTurn, turn_rad / time_s, with_margin * params_.max_turn_rad_per_s);
}

// Checks the arm's placement against plane, sphere and zones. Sphere and zones are enforced once the arm has
// been inside.
GuardReason GuardMonitor::CheckPlacement(const GuardKinematics::Placement& arm) OSTEON_RT {
  const WorkspaceParams& w = params_.workspace;
  const Vector3& p_WT = arm.p_WT;
  const double from_centre_m = (p_WT - w.sphere_center_W_m).norm(),
               above_m = w.plane_normal_W.dot(p_WT) - w.plane_offset_m;
  been_inside_ |= from_centre_m <= w.sphere_radius_m;
  if (const GuardReason reason = CheckZones(arm); reason.finding != GuardFinding::kNone) return reason;
  if (!(above_m >= -params_.workspace_margin_m))
    return {.finding = GuardFinding::kPlane, .found = above_m, .min = -params_.workspace_margin_m};
  if (!been_inside_) return {};
  return CheckAtMost(GuardFinding::kWorkspace, from_centre_m, w.sphere_radius_m + params_.workspace_margin_m);
}

// Returns the last zone in the list that is violated. A zone is enforced once its point has been inside.
GuardReason GuardMonitor::CheckZones(const GuardKinematics::Placement& arm) OSTEON_RT {
  GuardReason reason;
  for (std::size_t i = 0; i < params_.workspace.zones.size(); ++i) {
    const ZoneParams& zone = params_.workspace.zones[i];
    const Vector3& p_W = zone.point == ZonePoint::kElbow    ? arm.p_WElbow
                         : zone.point == ZonePoint::kFlange ? arm.p_WFlange
                                                            : arm.p_WT;
    const double inside_m = GuardZoneMargin_m(zone, p_W);
    been_in_zone_[i] |= inside_m >= 0.0;
    if (been_in_zone_[i] && !(inside_m >= -params_.workspace_margin_m))
      reason = {.finding = GuardFinding::kZone,
                .joint = static_cast<int>(i) + 1,
                .found = inside_m,
                .min = -params_.workspace_margin_m};
  }
  return reason;
}

bool GuardMonitor::AtStart(const Joints& q) const OSTEON_RT {
  return !params_.q_start || (q - ToJoints(*params_.q_start)).cwiseAbs().maxCoeff() <= params_.tolerance_rad;
}

bool GuardMonitor::Relaxes(const Joints& q) const OSTEON_RT {
  const Joints to_measured = ToJoints(arm_message_.q_meas) - q_before_, step = q - q_before_;
  for (int i = 0; i < 7; ++i)
    if (step[i] * to_measured[i] < 0.0 || !(std::abs(step[i]) <= kRounding * std::abs(to_measured[i])))
      return false;
  return true;
}

// Checks the wrench and the joint torques that the controller adds to the motion.
GuardReason GuardMonitor::CheckOverlay(const GuardCommand& command) const OSTEON_RT {
  if (command.wrench) {
    const Vector3 f = Eigen::Map<const Vector3>(command.wrench->data()),
                  t = Eigen::Map<const Vector3>(command.wrench->data() + 3);
    for (const double value : *command.wrench)
      if (!std::isfinite(value)) return {.finding = GuardFinding::kNotFinite, .found = value};
    if (const GuardReason reason =
            CheckAtMost(GuardFinding::kForce, f.stableNorm(), kRounding * params_.max_force_N);
        reason.finding != GuardFinding::kNone)
      return reason;
    if (const GuardReason reason =
            CheckAtMost(GuardFinding::kTorque, t.stableNorm(), kRounding * params_.max_torque_Nm);
        reason.finding != GuardFinding::kNone)
      return reason;
  }
  if (!command.tau) return {};
  const Joints tau = ToJoints(*command.tau);
  if (const int joint = FirstNotFinite(tau); joint > 0)
    return {.finding = GuardFinding::kNotFinite, .joint = joint, .found = tau[joint - 1]};
  const Joints q = ToJoints(arm_message_.q_meas);
  const GuardKinematics::JointMotions motions = arm_.ComputeJointMotions(q, arm_.ComputePlacement(q).p_WT);
  for (int i = 0; i < 7; ++i) {
    const auto joint = static_cast<std::size_t>(i);
    // largest torque that a wrench within max_force and max_torque needs at this joint
    const double max_Nm =
        motions.v[joint].norm() * params_.max_force_N + motions.w[joint].norm() * params_.max_torque_Nm;
    if (const GuardReason reason =
            CheckAtMost(GuardFinding::kJointTorque, std::abs(tau[i]), kRounding * max_Nm, i + 1);
        reason.finding != GuardFinding::kNone)
      return reason;
  }
  return {};
}

}  // namespace osteon::safety
