#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "control/tick_record.h"
#include "simulation/engine/frame_record.h"

// Names every number of a recorded tick or frame: the columns of a table, and the values that a replay
// compares. A visitor is called as visit(FieldName, value); a value is double, or an integer of any size.

namespace osteon::session {

/// A field's name in parts, joined by `_` with empty parts left out: X_WT_cmd_x_m.
struct FieldName {
  const char* name{""};
  const char* part{""};
  const char* unit{""};

  /// Returns the joined name.
  [[nodiscard]] std::string Text() const {
    std::string text = name;
    for (const char* more : {part, unit})
      if (*more != '\0') text += std::string("_") + more;
    return text;
  }
};

namespace fields {

inline constexpr std::array<const char*, 7> kJoint{"1", "2", "3", "4", "5", "6", "7"};
inline constexpr std::array<const char*, 9> kRotation{"R11", "R12", "R13", "R21", "R22",
                                                      "R23", "R31", "R32", "R33"};

// Each of the following functions visits the numbers of one value.

template <class Visit>
void Joints(const char* name, const std::array<double, 7>& values, const char* unit, Visit& visit) {
  for (std::size_t i = 0; i < values.size(); ++i) visit(FieldName{name, kJoint[i], unit}, values[i]);
}

template <class Visit>
void Vector(const char* name, const PlainVector3& v, const char* unit, Visit& visit) {
  visit(FieldName{name, "x", unit}, v.x);
  visit(FieldName{name, "y", unit}, v.y);
  visit(FieldName{name, "z", unit}, v.z);
}

template <class Visit>
void Transform(const char* name, const PlainPose& X, Visit& visit) {
  Vector(name, X.p, "m", visit);
  for (std::size_t i = 0; i < X.R.size(); ++i) visit(FieldName{name, kRotation[i], ""}, X.R[i]);
}

template <class Visit>
void ForceTorque(const char* name, const PlainWrench& F, Visit& visit) {
  Vector(name, F.f, "N", visit);
  Vector(name, F.t, "Nm", visit);
}

/// Visits the fields of compliance. In a rigid cell, and in recordings from before these fields existed, all
/// are zero, including the poses.
template <class Visit>
void Compliance(const control::ComplianceRecord& r, Visit& visit) {
  PlainPose zeros;
  zeros.R.fill(0.0);
  visit(FieldName{"compliance_present"}, static_cast<unsigned>(r.present));
  Transform("compliance_X_ME", r.present ? r.X_ME : zeros, visit);
  Transform("compliance_X_WM", r.present ? r.X_WM : zeros, visit);
  Vector("compliance_bend", r.bend_m, "m", visit);
  Vector("compliance_bend", r.bend_rad, "rad", visit);
  Vector("compliance_layer", r.layer_m, "m", visit);
  Vector("compliance_mount", r.mount_m, "m", visit);
  Vector("compliance_mount", r.mount_rad, "rad", visit);
  Vector("compliance_mount_speed", r.mount_m_per_s, "m_per_s", visit);
  Vector("compliance_mount_speed", r.mount_rad_per_s, "rad_per_s", visit);
}

}  // namespace fields

/// Visits the results of ServoLoop::Tick: the tick's inputs and the ticks before determine them bit for bit.
template <class Visit>
void VisitOutputs(const control::TickRecord& r, Visit&& visit) {
  visit(FieldName{"tick"}, r.tick);
  visit(FieldName{"stamp", "", "ns"}, r.stamp);
  visit(FieldName{"phase"}, static_cast<unsigned>(r.phase));
  visit(FieldName{"cell_state"}, static_cast<unsigned>(r.cell_state));
  visit(FieldName{"permits"}, r.permits);
  visit(FieldName{"session_state"}, static_cast<unsigned>(r.session_state));
  visit(FieldName{"faults"}, r.faults);
  fields::Joints("q_meas", r.q_meas, "rad", visit);
  fields::Joints("q_cmd", r.q_cmd, "rad", visit);
  fields::Transform("X_WT_cmd", r.X_WT_cmd, visit);
  fields::Transform("X_WT_meas", r.X_WT_meas, visit);
  fields::Vector("v_WT_cmd", r.v_WT_cmd_m_per_s, "m_per_s", visit);
  visit(FieldName{"tool_speed_meas", "", "m_per_s"}, r.tool_speed_meas_m_per_s);
  fields::ForceTorque("F_operator_T_W", r.F_operator_T_W, visit);
  fields::ForceTorque("F_coupling_T_W", r.F_coupling_T_W, visit);
  visit(FieldName{"wrench_step", "", "N"}, r.wrench_step_N);
  visit(FieldName{"wrench_step_limit", "", "N"}, r.wrench_step_limit_N);
  visit(FieldName{"wrench_scale"}, r.wrench_scale);
  visit(FieldName{"arm_share"}, r.arm_share);
  visit(FieldName{"tool_in_bone", "", "m"}, r.tool_in_bone_m);
  visit(FieldName{"vibration_index"}, r.vibration_index);
  visit(FieldName{"vibration_reference", "", "N"}, r.vibration_reference_N);
  visit(FieldName{"mass_factor"}, r.mass_factor);
  visit(FieldName{"damping_factor"}, r.damping_factor);
  visit(FieldName{"age_damping_factor"}, r.age_damping_factor);
  visit(FieldName{"age_wrench_share"}, r.age_wrench_share);
  visit(FieldName{"passivity_energy", "", "J"}, r.passivity_energy_J);
  visit(FieldName{"passivity_damping", "", "Ns_per_m"}, r.passivity_damping_Ns_per_m);
  visit(FieldName{"tank", "", "J"}, r.tank_J);
  visit(FieldName{"tank_share"}, r.tank_share);
  fields::ForceTorque("guidance_F_T_W", r.guidance.F_T_W, visit);
  visit(FieldName{"guidance_share"}, r.guidance.share);
  visit(FieldName{"guidance_potential", "", "J"}, r.guidance.potential_J);
  visit(FieldName{"guidance_energy", "", "J"}, r.guidance.energy_J);
  visit(FieldName{"guidance_cone", "", "rad"}, r.guidance.cone_rad);
  visit(FieldName{"guidance_lateral", "", "m"}, r.guidance.lateral_m);
  visit(FieldName{"guidance_depth", "", "m"}, r.guidance.depth_m);
  visit(FieldName{"guidance_present"}, static_cast<unsigned>(r.guidance.present));
  visit(FieldName{"guidance_stops_spindle"}, static_cast<unsigned>(r.guidance.stops_spindle));
  fields::Compliance(r.compliance, visit);
  visit(FieldName{"limits"}, r.limits);
  fields::ForceTorque("F_bias_S", r.F_bias_S, visit);
  visit(FieldName{"activation_cmd"}, r.activation_cmd);
  fields::ForceTorque("F_cmd_T", r.F_cmd_T, visit);
  fields::Joints("tau_cmd", r.tau_cmd, "Nm", visit);
  visit(FieldName{"model_age", "", "s"}, r.model_age_s);
  visit(FieldName{"sensor_age", "", "s"}, r.sensor_age_s);
  visit(FieldName{"model_frame"}, r.model_frame);
  visit(FieldName{"spindle", "", "rad_per_s"}, r.spindle_rad_per_s);
}

/// Visits the tick's inputs and its durations.
template <class Visit>
void VisitInputs(const control::TickRecord& r, Visit&& visit) {
  const control::TickInput& in = r.input;
  visit(FieldName{"wakeup", "", "ns"}, r.wakeup_ns);
  visit(FieldName{"compute", "", "ns"}, r.compute_ns);
  visit(FieldName{"now", "", "ns"}, in.now);
  visit(FieldName{"arm_stamp", "", "ns"}, in.arm_stamp);
  visit(FieldName{"arm_sequence"}, in.sequence);
  visit(FieldName{"arm_lost"}, in.lost);
  visit(FieldName{"arm_duplicate"}, in.duplicate);
  visit(FieldName{"arm_late"}, in.late);
  visit(FieldName{"arm_reordered"}, in.reordered);
  visit(FieldName{"arm_rejected"}, in.rejected);
  visit(FieldName{"arm_other_version"}, in.other_version);
  visit(FieldName{"arm_answers_lost"}, in.answers_lost);
  visit(FieldName{"arm_answers_foreign"}, in.answers_foreign);
  visit(FieldName{"arm_activation"}, in.activation);
  visit(FieldName{"arm_holding"}, static_cast<unsigned>(in.holding));
  visit(FieldName{"arm_operation_mode"}, static_cast<unsigned>(in.operation_mode));
  visit(FieldName{"arm_control_mode"}, static_cast<unsigned>(in.control_mode));
  visit(FieldName{"arm_command_mode"}, static_cast<unsigned>(in.command_mode));
  visit(FieldName{"arm_drives_active"}, static_cast<unsigned>(in.drives_active));
  visit(FieldName{"arm_received"}, static_cast<unsigned>(in.received));
  visit(FieldName{"arm_quality"}, static_cast<unsigned>(in.quality));
  visit(FieldName{"arm_safety_state"}, static_cast<unsigned>(in.safety_state));
  visit(FieldName{"arm_period", "", "s"}, in.period_s);
  visit(FieldName{"has_ipo"}, static_cast<unsigned>(in.has_ipo));
  fields::Joints("q_ipo", in.q_ipo, "rad", visit);
  fields::Joints("tau_ext", in.tau_ext, "Nm", visit);
  visit(FieldName{"stop"}, static_cast<unsigned>(in.stop));
  visit(FieldName{"recover"}, static_cast<unsigned>(in.recover));
  visit(FieldName{"pause"}, static_cast<unsigned>(in.pause));
  visit(FieldName{"resume"}, static_cast<unsigned>(in.resume));
  visit(FieldName{"repeat_differed"}, static_cast<unsigned>(in.repeat_differed));
  visit(FieldName{"recorder_stalled"}, static_cast<unsigned>(in.recorder_stalled));
  visit(FieldName{"tool_index"}, static_cast<unsigned>(in.tool_index));
  visit(FieldName{"sensor_stamp", "", "ns"}, in.sensor_stamp);
  fields::ForceTorque("F_sensor_S", in.F_sensor_S, visit);
  visit(FieldName{"sensor_trusted"}, static_cast<unsigned>(in.sensor_trusted));
  visit(FieldName{"spindle_stamp", "", "ns"}, in.spindle_stamp);
  visit(FieldName{"spindle_meas", "", "rad_per_s"}, in.spindle_meas_rad_per_s);
  visit(FieldName{"spindle_torque", "", "Nm"}, in.spindle_torque_Nm);
  visit(FieldName{"spindle_ready"}, static_cast<unsigned>(in.spindle_ready));
  visit(FieldName{"spindle_fault"}, static_cast<unsigned>(in.spindle_fault));
  visit(FieldName{"drive_faults"}, static_cast<unsigned>(in.drive_faults));
  visit(FieldName{"drive_nmt_state"}, static_cast<unsigned>(in.drive_nmt_state));
  visit(FieldName{"drive_emergency_code"}, static_cast<unsigned>(in.drive_emergency_code));
  visit(FieldName{"drive_error_code"}, static_cast<unsigned>(in.drive_error_code));
  visit(FieldName{"interlock_stamp", "", "ns"}, in.interlock_stamp);
  visit(FieldName{"permitted"}, static_cast<unsigned>(in.permitted));
  visit(FieldName{"enabled"}, static_cast<unsigned>(in.enabled));
  visit(FieldName{"spindle_permitted"}, static_cast<unsigned>(in.spindle_permitted));
  visit(FieldName{"interlock_reason"}, static_cast<unsigned>(in.interlock_reason));
  visit(FieldName{"model_status"}, static_cast<unsigned>(in.model_status));
  visit(FieldName{"model_pose_stamp", "", "ns"}, in.model_pose_stamp);
  visit(FieldName{"guidance_gain_taken"}, static_cast<unsigned>(in.has_guidance_gain));
  visit(FieldName{"guidance_gain"}, in.guidance_gain);
  visit(FieldName{"gains_taken"}, static_cast<unsigned>(in.has_gains));
  control::VisitGains(in.gains, [&](const char* name, const char* axis, const char* unit, double value) {
    visit(FieldName{name, axis, unit}, value);
  });
}

/// Visits a frame without its contacts.
template <class Visit>
void VisitFrame(const simulation::FrameRecord& r, Visit&& visit) {
  const simulation::ContactModel& m = r.model;
  visit(FieldName{"frame"}, m.frame);
  visit(FieldName{"stamp", "", "ns"}, r.stamp);
  visit(FieldName{"pose_stamp", "", "ns"}, m.pose_stamp);
  visit(FieldName{"duration", "", "ns"}, r.duration_ns);
  visit(FieldName{"status"}, static_cast<unsigned>(m.status));
  visit(FieldName{"cup_depth", "", "m"}, r.cup_depth_m);
  fields::Transform("X_WP", m.X_WP, visit);
  fields::Vector("n_W", m.n_W, "", visit);
  visit(FieldName{"contact_fraction"}, m.contact_fraction);
  fields::Vector("p_WS", m.p_WS_m, "m", visit);
  fields::ForceTorque("F_T_W", m.F_T_W, visit);
  visit(FieldName{"advance", "", "m_per_s"}, m.advance_m_per_s);
  visit(FieldName{"engaged_area", "", "m2"}, m.engaged_area_m2);
  visit(FieldName{"spindle_torque", "", "Nm"}, m.spindle_torque_Nm);
  visit(FieldName{"removed_volume", "", "m3"}, m.removed_volume_m3);
  visit(FieldName{"removed_mass", "", "kg"}, m.removed_mass_kg);
  visit(FieldName{"cutting_work", "", "J"}, m.cutting_work_J);
  visit(FieldName{"balls_not_split"}, m.balls_not_split);
  visit(FieldName{"contact_count"}, m.contact_count);
}

/// Visits one contact of a frame.
template <class Visit>
void VisitContact(const simulation::Contact& c, Visit&& visit) {
  fields::Vector("p_TP", c.p_TP_m, "m", visit);
  fields::Vector("p_W", c.p_W_m, "m", visit);
  fields::Vector("n_W", c.n_W, "", visit);
  visit(FieldName{"gap", "", "m"}, c.gap_m);
  visit(FieldName{"stiffness", "", "N_per_m"}, c.stiffness_N_per_m);
  visit(FieldName{"mu"}, c.mu);
  visit(FieldName{"advance", "", "m_per_s"}, c.advance_m_per_s);
  visit(FieldName{"weight"}, c.weight);
  visit(FieldName{"material"}, static_cast<unsigned>(c.material));
}

}  // namespace osteon::session
