#include "config/reading/sections/read_limits.h"

#include <cmath>

#include <fmt/format.h>

#include "config/reading/sections/read_pose.h"

namespace osteon::config {
namespace {

// Default of max_tool_in_bone_mm: twice the depth at which the coupling reaches its force limit, plus this.
constexpr double kToolInBoneMargin_m = 3e-3;

// Reads the keys of a zone's shape: a point on the face of a half-space, or the centre of another shape, and
// the shape's dimensions.
void ReadShapeKeys(Reader& section, safety::ZoneParams& zone) {
  using safety::ZoneShape;
  zone.shape =
      static_cast<ZoneShape>(section.Choice("shape", {"half_space", "sphere", "box", "cylinder", "capsule"}));
  zone.p_W_m = section.Triple("at_mm", -kRoom_mm, kRoom_mm);
  switch (zone.shape) {
    case ZoneShape::kHalfSpace:
      zone.R_W = RotationFromZTo(section.Direction("inward_axis"));
      return;
    case ZoneShape::kSphere:
      zone.radius_m = section.Number("radius_mm", 1, kRoom_mm);
      return;
    case ZoneShape::kBox: {
      zone.half_edge_m = 0.5 * section.Triple("edges_mm", 1, 2 * kRoom_mm);
      if (section.Has("turn_deg")) {
        const Vector3 turn = section.Triple("turn_deg", -180, 180);
        zone.R_W =
            (Eigen::AngleAxisd(turn.z(), Vector3::UnitZ()) * Eigen::AngleAxisd(turn.y(), Vector3::UnitY()) *
             Eigen::AngleAxisd(turn.x(), Vector3::UnitX()))
                .toRotationMatrix();
      }
      return;
    }
    case ZoneShape::kCylinder:
    case ZoneShape::kCapsule:
      zone.R_W = RotationFromZTo(section.Direction("along_axis"));
      zone.radius_m = section.Number("radius_mm", 1, kRoom_mm);
      zone.half_length_m = 0.5 * section.Number("length_mm", 1, 2 * kRoom_mm);
      return;
  }
}

// Reads a shape. If its keys are in the bone's frame, converts it to W.
void ReadShape(Reader& section, const Pose& X_WG, safety::ZoneParams& zone) {
  ReadShapeKeys(section, zone);
  if (!IsInBoneFrame(section)) return;
  zone.p_W_m = X_WG * Vector3(zone.p_W_m);
  zone.R_W = X_WG.linear() * Matrix3(zone.R_W);
}

}  // namespace

bool IsInBoneFrame(Reader& section) {
  return section.Has("frame") && section.Choice("frame", {"world", "bone"}) == 1;
}

void ReadLimits(Reader section, bool lbr, control::ServoParams& servo) {
  servo.wrench.max_force_N = section.Number("max_force_N", 1, safety::kForceCeiling_N);
  servo.wrench.max_torque_Nm = section.Number("max_torque_Nm", 0.1, 50);
  servo.sensor_force.margin_N = section.Number("sensor_margin_N", 1, 200);
  servo.sensor_force.ticks = section.WholeNumber("sensor_trip_count", 1, 100);
  servo.twist.max_speed_m_per_s = section.Number("max_tool_speed_mm_per_s", 1, 1000);
  servo.twist.max_turn_rad_per_s = section.Number("max_tool_turn_deg_per_s", 1, 360);
  servo.stop_deceleration_m_per_s2 = section.Number("stop_deceleration_mm_per_s2", 100, 20000);
  servo.stop_deceleration_rad_per_s2 = section.Number("stop_deceleration_rad_per_s2", 0.5, 100);
  servo.joint_stop_s = section.Number("joint_stop_ms", 10, 1000);
  servo.joints.position_margin_rad = section.Number("joint_margin_deg", 0, 30);
  servo.joints.speed_share = section.Number("joint_speed_ratio", 0.01, 1);
  servo.joints.jump_rad = section.Number("joint_jump_deg", 0.1, 30);
  servo.max_tracking_error_m = section.Number("max_tracking_error_mm", 1, 200);
  if (lbr) servo.arm_angle_rate_rad_per_s = section.Number("arm_angle_rate_deg_per_s", 0.1, 57);
  servo.model_sight_m = section.Number("model_sight_mm", 0.01, 100);
  // The bounds below are optional. If two bounds limit the same quantity, the tighter one applies.
  if (section.Has("max_elbow_speed_mm_per_s"))
    servo.max_elbow_speed_m_per_s = section.Number("max_elbow_speed_mm_per_s", 1, 2000);
  if (section.Has("max_stored_J")) servo.energy.max_stored_J = section.Number("max_stored_J", 0.01, 1000);
  if (section.Has("on_force_limit"))
    servo.on_force_limit.reaction =
        static_cast<safety::OnForceLimit>(section.Choice("on_force_limit", {"yield", "slow", "stop"}));
  if (section.Has("max_tool_in_bone_mm"))
    servo.on_force_limit.max_tool_in_bone_m = section.Number("max_tool_in_bone_mm", 0.1, 500);
  if (section.Has("max_power_W")) servo.energy.max_power_W = section.Number("max_power_W", 0.1, 1000);
  if (section.Has("max_kinetic_J")) {
    servo.energy.max_kinetic_J = section.Number("max_kinetic_J", 0.001, 100);
    servo.energy.moving_mass_kg = section.Number("moving_mass_kg", 0.1, 500);
  }
  // Torque and speed are still ratios of the tool's values here. PropagateSharedValues (load_cell.cpp)
  // converts them.
  if (section.Has("spindle_torque_ratio")) {
    servo.spindle_limits.max_torque_Nm = section.Number("spindle_torque_ratio", 0.1, 100);
    servo.spindle_limits.max_speed_rad_per_s = section.Number("spindle_speed_ratio", 1.01, 10);
    servo.spindle_limits.trip_s = section.Number("spindle_trip_ms", 0, 10000);
  }
}

void CompleteForceLimit(Reader limits, control::ServoParams& servo) {
  safety::ForceLimitReactionParams& reaction = servo.on_force_limit;
  const bool impedance = servo.law == control::Law::kImpedance;
  if (impedance && limits.Has("on_force_limit") && reaction.reaction == safety::OnForceLimit::kSlow)
    limits.Refuse(
        "on_force_limit",
        "found slow with the impedance law, accepted yield or stop: the arm is where the hand has it, and "
        "what could slow it down is the wrench that is at its limit");
  if (impedance && !limits.Has("on_force_limit")) reaction.reaction = safety::OnForceLimit::kYield;
  // depth in the bone at which the coupling reaches its force limit
  const double at_limit_m = control::ForceLimit_N(servo) / servo.coupling.max_stiffness_N_per_m;
  if (!std::isfinite(reaction.max_tool_in_bone_m)) {
    reaction.max_tool_in_bone_m = 2.0 * at_limit_m + kToolInBoneMargin_m;
  } else if (!(reaction.max_tool_in_bone_m > at_limit_m)) {
    limits.Refuse(
        "max_tool_in_bone_mm",
        fmt::format(
            "found {:.10g}, accepted more than {:.4g}: there the coupling of {:.10g} N/mm reaches its "
            "force limit of {:.4g} N",
            1e3 * reaction.max_tool_in_bone_m, 1e3 * at_limit_m, 1e-3 * servo.coupling.max_stiffness_N_per_m,
            control::ForceLimit_N(servo)));
  }
}

void ReadZones(Reader& cell, const Pose& X_WG, safety::WorkspaceParams& workspace) {
  if (!cell.Has("zones")) return;
  for (Reader& section : cell.Sections("zones", 1, safety::Workspace::kMaxZones - 1)) {
    safety::ZoneParams& zone = workspace.zones.emplace_back();
    zone.point = static_cast<safety::ZonePoint>(section.Choice("point", {"apex", "flange", "elbow"}));
    zone.side = static_cast<safety::ZoneSide>(section.Choice("keep", {"in", "out"}));
    ReadShape(section, X_WG, zone);
  }
}

void ReadDepthLimit(Reader& cell, const Pose& X_WG, safety::DepthLimitParams& depth) {
  if (!cell.Has("depth_limit")) return;
  Reader section = cell.Section("depth_limit");
  depth.acts = section.Bool("acts");
  ReadShape(section, X_WG, depth.bound);
  depth.soft_m = section.Number("soft_mm", 0.1, 100);
  depth.spindle_stop_m = section.Number("spindle_stop_mm", 0, 100);
  depth.stiffness_N_per_m = section.Number("stiffness_N_per_mm", 0.1, 100);
  depth.damping_Ns_per_m = section.Number("damping_Ns_per_m", 0, 10000);
  if (section.Has("rides_on_bone")) depth.rides_on_bone = section.Bool("rides_on_bone");
}

void CheckDepthLimit(Reader cell, const safety::DepthLimitParams& depth, double coupling_N_per_m) {
  if (!depth.acts) return;
  const Reader section = cell.Section("depth_limit");
  if (depth.spindle_stop_m > depth.soft_m)
    section.Refuse("spindle_stop_mm", fmt::format("found {:.10g}, accepted at most soft_mm ({:.10g}): the "
                                                  "spindle stops within the resistance",
                                                  1e3 * depth.spindle_stop_m, 1e3 * depth.soft_m));
  if (depth.stiffness_N_per_m > coupling_N_per_m)
    section.Refuse("stiffness_N_per_mm",
                   fmt::format("found {:.10g}, accepted at most the coupling's {:.10g}: what the loop is "
                               "known to be stable with",
                               1e-3 * depth.stiffness_N_per_m, 1e-3 * coupling_N_per_m));
}

}  // namespace osteon::config
