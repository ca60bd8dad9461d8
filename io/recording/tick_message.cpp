// Encodes a tick's record as an osteon.Tick message and decodes it. FillMessage writes one part of the
// record, Get reads it back. If an older recording lacks a field, the record keeps its default.
#include <stdexcept>

#include "io/recording/message_parts.h"
#include "io/recording/messages.h"
#include "safety/cell_state.h"

namespace osteon::io {

using control::TickRecord;

namespace {

void FillMessage(const control::Gains& from, osteon::Gains* to) {
  io::FillMessage(from.mass_kg, to->mutable_mass_kg());
  io::FillMessage(from.inertia_kg_m2, to->mutable_inertia_kg_m2());
  io::FillMessage(from.damping_Ns_per_m, to->mutable_damping_ns_per_m());
  io::FillMessage(from.damping_Nms_per_rad, to->mutable_damping_nms_per_rad());
  to->set_dead_zone_n(from.dead_zone_N);
  to->set_dead_zone_nm(from.dead_zone_Nm);
  to->set_max_stiffness_n_per_m(from.max_stiffness_N_per_m);
  to->set_coupling_damping_ns_per_m(from.coupling_damping_Ns_per_m);
  to->set_damping_share(from.damping_share);
}

// Returns an empty string, or the error. Gains are checked here because a replay passes them to a servo loop,
// which accepts only valid gains.
std::string Get(const osteon::Gains& from, control::Gains& to) {
  io::Get(from.mass_kg(), to.mass_kg);
  io::Get(from.inertia_kg_m2(), to.inertia_kg_m2);
  io::Get(from.damping_ns_per_m(), to.damping_Ns_per_m);
  io::Get(from.damping_nms_per_rad(), to.damping_Nms_per_rad);
  to.dead_zone_N = from.dead_zone_n();
  to.dead_zone_Nm = from.dead_zone_nm();
  to.max_stiffness_N_per_m = from.max_stiffness_n_per_m();
  to.coupling_damping_Ns_per_m = from.coupling_damping_ns_per_m();
  to.damping_share = from.damping_share();
  try {
    control::Validate(to);
  } catch (const std::invalid_argument& error) {
    return std::string("gains: ") + error.what();
  }
  return {};
}

void FillMessage(const control::GuidanceRecord& from, osteon::Guidance* to) {
  io::FillMessage(from.F_T_W, to->mutable_f_t_w());
  to->set_share(from.share);
  to->set_potential_j(from.potential_J);
  to->set_energy_j(from.energy_J);
  to->set_cone_rad(from.cone_rad);
  to->set_lateral_m(from.lateral_m);
  to->set_depth_m(from.depth_m);
  to->set_stops_spindle(from.stops_spindle);
}

void Get(const osteon::Guidance& from, control::GuidanceRecord& to) {
  to.present = true;
  io::Get(from.f_t_w(), to.F_T_W);
  to.share = from.share();
  to.potential_J = from.potential_j();
  to.energy_J = from.energy_j();
  to.cone_rad = from.cone_rad();
  to.lateral_m = from.lateral_m();
  to.depth_m = from.depth_m();
  to.stops_spindle = from.stops_spindle();
}

void FillMessage(const control::ComplianceRecord& from, osteon::Compliance* to) {
  io::FillMessage(from.X_ME, to->mutable_x_me());
  io::FillMessage(from.X_WM, to->mutable_x_wm());
  io::FillMessage(from.bend_m, to->mutable_bend_m());
  io::FillMessage(from.bend_rad, to->mutable_bend_rad());
  io::FillMessage(from.layer_m, to->mutable_layer_m());
  io::FillMessage(from.mount_m, to->mutable_mount_m());
  io::FillMessage(from.mount_rad, to->mutable_mount_rad());
  io::FillMessage(from.mount_m_per_s, to->mutable_mount_m_per_s());
  io::FillMessage(from.mount_rad_per_s, to->mutable_mount_rad_per_s());
}

// Returns whether both rotations have 9 elements.
bool Get(const osteon::Compliance& from, control::ComplianceRecord& to) {
  to.present = true;
  io::Get(from.bend_m(), to.bend_m);
  io::Get(from.bend_rad(), to.bend_rad);
  io::Get(from.layer_m(), to.layer_m);
  io::Get(from.mount_m(), to.mount_m);
  io::Get(from.mount_rad(), to.mount_rad);
  io::Get(from.mount_m_per_s(), to.mount_m_per_s);
  io::Get(from.mount_rad_per_s(), to.mount_rad_per_s);
  return io::Get(from.x_me(), to.X_ME) && io::Get(from.x_wm(), to.X_WM);
}

void FillMessage(const control::TickInput& from, osteon::TickInput* to) {
  to->set_now_ns(from.now);
  to->set_arm_stamp_ns(from.arm_stamp);
  to->set_sequence(from.sequence);
  to->set_lost(from.lost);
  to->set_duplicate(from.duplicate);
  to->set_late(from.late);
  to->set_rejected(from.rejected);
  to->set_received(static_cast<osteon::TickInput::Received>(from.received));
  to->set_quality(from.quality);
  to->set_safety_state(from.safety_state);
  to->set_stop(from.stop);
  to->set_recover(from.recover);
  to->set_repeat_differed(from.repeat_differed);
  to->set_recorder_stalled(from.recorder_stalled);
  to->set_tool_index(from.tool_index);
  to->set_pause(from.pause);
  to->set_resume(from.resume);
  to->set_model_status(from.model_status);
  to->set_period_s(from.period_s);
  if (from.has_ipo) to->mutable_q_ipo_rad()->Assign(from.q_ipo.begin(), from.q_ipo.end());
  to->mutable_tau_ext_nm()->Assign(from.tau_ext.begin(), from.tau_ext.end());
  to->set_sensor_stamp_ns(from.sensor_stamp);
  io::FillMessage(from.F_sensor_S, to->mutable_f_sensor_s());
  to->set_model_pose_stamp_ns(from.model_pose_stamp);
  to->set_activation(from.activation);
  to->set_holding(from.holding);
  to->set_reordered(from.reordered);
  to->set_other_version(from.other_version);
  to->set_answers_lost(from.answers_lost);
  to->set_answers_foreign(from.answers_foreign);
  to->set_operation_mode(from.operation_mode);
  to->set_control_mode(from.control_mode);
  to->set_command_mode(from.command_mode);
  to->set_drives_active(from.drives_active);
  to->set_sensor_trusted(from.sensor_trusted);
  to->set_spindle_stamp_ns(from.spindle_stamp);
  to->set_spindle_meas_rad_per_s(from.spindle_meas_rad_per_s);
  to->set_spindle_torque_nm(from.spindle_torque_Nm);
  to->set_spindle_ready(from.spindle_ready);
  to->set_spindle_fault(from.spindle_fault);
  to->set_drive_faults(from.drive_faults);
  to->set_drive_nmt_state(from.drive_nmt_state);
  to->set_drive_emergency_code(from.drive_emergency_code);
  to->set_drive_error_code(from.drive_error_code);
  to->set_interlock_stamp_ns(from.interlock_stamp);
  to->set_permitted(from.permitted);
  to->set_enabled(from.enabled);
  to->set_spindle_permitted(from.spindle_permitted);
  to->set_interlock_reason(from.interlock_reason);
  if (from.has_guidance_gain) to->set_guidance_gain(from.guidance_gain);
  if (from.has_gains) FillMessage(from.gains, to->mutable_gains());
}

// Returns an empty string, or the error.
std::string Get(const osteon::TickInput& from, control::TickInput& to) {
  if (!osteon::TickInput::Received_IsValid(from.received()))
    return "received " + std::to_string(from.received()) + ", accepted 0 … 2";
  // fields with a bound: values of enumerations, and numbers that the record stores in 8 or 16 bits
  struct BoundedField {
    const char* name;
    std::uint32_t value, max;
  };
  for (const BoundedField& each : {BoundedField{"quality", from.quality(), 3},
                                   {"safety_state", from.safety_state(), 3},
                                   {"operation_mode", from.operation_mode(), 2},
                                   {"control_mode", from.control_mode(), 3},
                                   {"command_mode", from.command_mode(), 4},
                                   {"model_status", from.model_status(), 3},
                                   {"interlock_reason", from.interlock_reason(), 6},
                                   {"drive_faults", from.drive_faults(), 0xFF},
                                   {"drive_nmt_state", from.drive_nmt_state(), 0xFF},
                                   {"drive_emergency_code", from.drive_emergency_code(), 0xFFFF},
                                   {"drive_error_code", from.drive_error_code(), 0xFFFF}})
    if (each.value > each.max)
      return std::string(each.name) + " " + std::to_string(each.value) + ", accepted 0 … " +
             std::to_string(each.max);
  to.now = from.now_ns();
  to.arm_stamp = from.arm_stamp_ns();
  to.sequence = from.sequence();
  to.lost = from.lost();
  to.duplicate = from.duplicate();
  to.late = from.late();
  to.rejected = from.rejected();
  to.received = static_cast<std::uint8_t>(from.received());
  to.quality = static_cast<std::uint8_t>(from.quality());
  to.safety_state = static_cast<std::uint8_t>(from.safety_state());
  to.has_ipo = from.q_ipo_rad_size() > 0;
  to.stop = from.stop();
  to.recover = from.recover();
  to.repeat_differed = from.repeat_differed();
  to.recorder_stalled = from.recorder_stalled();
  to.tool_index = static_cast<std::uint8_t>(from.tool_index());
  to.pause = from.pause();
  to.resume = from.resume();
  to.model_status = static_cast<std::uint8_t>(from.model_status());
  to.period_s = from.period_s();
  if (to.has_ipo && !io::Get(from.q_ipo_rad(), to.q_ipo)) return "not 7 joint values";
  if (!io::Get(from.tau_ext_nm(), to.tau_ext)) return "not 7 joint values";
  to.sensor_stamp = from.sensor_stamp_ns();
  io::Get(from.f_sensor_s(), to.F_sensor_S);
  to.model_pose_stamp = from.model_pose_stamp_ns();
  to.activation = from.activation();
  to.holding = from.holding();
  to.reordered = from.reordered();
  to.other_version = from.other_version();
  to.answers_lost = from.answers_lost();
  to.answers_foreign = from.answers_foreign();
  to.operation_mode = static_cast<std::uint8_t>(from.operation_mode());
  to.control_mode = static_cast<std::uint8_t>(from.control_mode());
  to.command_mode = static_cast<std::uint8_t>(from.command_mode());
  to.drives_active = from.drives_active();
  to.sensor_trusted = !from.has_sensor_trusted() || from.sensor_trusted();
  to.spindle_stamp = from.spindle_stamp_ns();
  to.spindle_meas_rad_per_s = from.spindle_meas_rad_per_s();
  to.spindle_torque_Nm = from.spindle_torque_nm();
  to.spindle_ready = from.spindle_ready();
  to.spindle_fault = from.spindle_fault();
  to.drive_faults = static_cast<std::uint8_t>(from.drive_faults());
  to.drive_nmt_state = static_cast<std::uint8_t>(from.drive_nmt_state());
  to.drive_emergency_code = static_cast<std::uint16_t>(from.drive_emergency_code());
  to.drive_error_code = static_cast<std::uint16_t>(from.drive_error_code());
  to.interlock_stamp = from.interlock_stamp_ns();
  to.permitted = from.permitted();
  to.enabled = from.enabled();
  to.spindle_permitted = from.spindle_permitted();
  to.interlock_reason = static_cast<std::uint8_t>(from.interlock_reason());
  to.has_guidance_gain = from.has_guidance_gain();
  if (to.has_guidance_gain) to.guidance_gain = from.guidance_gain();
  to.has_gains = from.has_gains();
  return to.has_gains ? Get(from.gains(), to.gains) : std::string();
}

// Returns a cleared message that reuses the memory of the one before, because a recording of hours has a
// hundred million messages.
Tick& ReusedTick() {
  static thread_local Tick message;
  message.Clear();
  return message;
}

}  // namespace

void Encode(const TickRecord& record, std::string& bytes) {
  Tick& message = ReusedTick();
  message.set_tick(record.tick);
  message.set_stamp_ns(record.stamp);
  message.set_phase(static_cast<Tick::Phase>(record.phase));
  message.set_session_state(record.session_state);
  message.set_faults(record.faults);
  message.mutable_q_meas_rad()->Assign(record.q_meas.begin(), record.q_meas.end());
  message.mutable_q_cmd_rad()->Assign(record.q_cmd.begin(), record.q_cmd.end());
  io::FillMessage(record.X_WT_cmd, message.mutable_x_wt_cmd());
  io::FillMessage(record.X_WT_meas, message.mutable_x_wt_meas());
  io::FillMessage(record.v_WT_cmd_m_per_s, message.mutable_v_wt_cmd_m_per_s());
  message.set_tool_speed_meas_m_per_s(record.tool_speed_meas_m_per_s);
  io::FillMessage(record.F_operator_T_W, message.mutable_f_operator_t_w());
  io::FillMessage(record.F_coupling_T_W, message.mutable_f_coupling_t_w());
  message.set_wrench_scale(record.wrench_scale);
  message.set_arm_share(record.arm_share);
  message.set_tool_in_bone_m(record.tool_in_bone_m);
  message.set_wrench_step_n(record.wrench_step_N);
  message.set_wrench_step_limit_n(record.wrench_step_limit_N);
  message.set_model_age_s(record.model_age_s);
  message.set_sensor_age_s(record.sensor_age_s);
  message.set_model_frame(record.model_frame);
  message.set_spindle_rad_per_s(record.spindle_rad_per_s);
  message.set_wakeup_ns(record.wakeup_ns);
  message.set_compute_ns(record.compute_ns);
  message.set_activation_cmd(record.activation_cmd);
  io::FillMessage(record.F_cmd_T, message.mutable_f_cmd_t());
  message.mutable_tau_cmd_nm()->Assign(record.tau_cmd.begin(), record.tau_cmd.end());
  FillMessage(record.input, message.mutable_input());
  message.set_vibration_index(record.vibration_index);
  message.set_vibration_reference_n(record.vibration_reference_N);
  message.set_mass_factor(record.mass_factor);
  message.set_damping_factor(record.damping_factor);
  message.set_age_damping_factor(record.age_damping_factor);
  message.set_age_wrench_share(record.age_wrench_share);
  message.set_passivity_energy_j(record.passivity_energy_J);
  message.set_passivity_damping_ns_per_m(record.passivity_damping_Ns_per_m);
  message.set_tank_j(record.tank_J);
  message.set_limits(record.limits);
  if (record.cell_state != control::kNoCellState) message.set_cell_state(record.cell_state);
  message.set_permits(record.permits);
  message.set_tank_share(record.tank_share);
  io::FillMessage(record.F_bias_S, message.mutable_f_bias_s());
  if (record.guidance.present) FillMessage(record.guidance, message.mutable_guidance());
  if (record.compliance.present) FillMessage(record.compliance, message.mutable_compliance());
  message.SerializeToString(&bytes);
}

std::string Decode(std::span<const char> bytes, TickRecord& record) {
  Tick& message = ReusedTick();
  if (!Parse(bytes, message)) return "not an osteon.Tick";
  if (!Tick::Phase_IsValid(message.phase()))
    return "phase " + std::to_string(message.phase()) + ", accepted 0 … 4";
  if (message.session_state() > 4)
    return "session_state " + std::to_string(message.session_state()) + ", accepted 0 … 4";
  TickRecord decoded;
  decoded.tick = message.tick();
  decoded.stamp = message.stamp_ns();
  decoded.phase = static_cast<control::Phase>(message.phase());
  decoded.session_state = static_cast<std::uint8_t>(message.session_state());
  decoded.faults = message.faults();
  if (!io::Get(message.q_meas_rad(), decoded.q_meas) || !io::Get(message.q_cmd_rad(), decoded.q_cmd))
    return "not 7 joint values";
  if (!io::Get(message.x_wt_cmd(), decoded.X_WT_cmd) || !io::Get(message.x_wt_meas(), decoded.X_WT_meas))
    return "not 9 elements of a rotation";
  io::Get(message.v_wt_cmd_m_per_s(), decoded.v_WT_cmd_m_per_s);
  decoded.tool_speed_meas_m_per_s = message.tool_speed_meas_m_per_s();
  io::Get(message.f_operator_t_w(), decoded.F_operator_T_W);
  io::Get(message.f_coupling_t_w(), decoded.F_coupling_T_W);
  decoded.wrench_scale = message.wrench_scale();
  if (message.has_arm_share()) decoded.arm_share = message.arm_share();
  decoded.tool_in_bone_m = message.tool_in_bone_m();
  decoded.wrench_step_N = message.wrench_step_n();
  decoded.wrench_step_limit_N = message.wrench_step_limit_n();
  decoded.model_age_s = message.model_age_s();
  decoded.sensor_age_s = message.sensor_age_s();
  decoded.model_frame = message.model_frame();
  decoded.spindle_rad_per_s = message.spindle_rad_per_s();
  decoded.wakeup_ns = message.wakeup_ns();
  decoded.compute_ns = message.compute_ns();
  decoded.activation_cmd = message.activation_cmd();
  decoded.vibration_index = message.vibration_index();
  decoded.vibration_reference_N = message.vibration_reference_n();
  if (message.has_mass_factor()) decoded.mass_factor = message.mass_factor();
  if (message.has_damping_factor()) decoded.damping_factor = message.damping_factor();
  if (message.has_age_damping_factor()) decoded.age_damping_factor = message.age_damping_factor();
  if (message.has_age_wrench_share()) decoded.age_wrench_share = message.age_wrench_share();
  decoded.passivity_energy_J = message.passivity_energy_j();
  decoded.passivity_damping_Ns_per_m = message.passivity_damping_ns_per_m();
  decoded.tank_J = message.tank_j();
  decoded.limits = message.limits();
  if (message.has_cell_state()) {
    if (message.cell_state() >= safety::kCellStates)
      return "cell_state " + std::to_string(message.cell_state()) + ", accepted 0 … " +
             std::to_string(safety::kCellStates - 1);
    decoded.cell_state = static_cast<std::uint8_t>(message.cell_state());
  }
  decoded.permits = message.permits();
  if (message.has_tank_share()) decoded.tank_share = message.tank_share();
  io::Get(message.f_bias_s(), decoded.F_bias_S);
  if (message.has_guidance()) Get(message.guidance(), decoded.guidance);
  if (message.has_compliance() && !Get(message.compliance(), decoded.compliance))
    return "not 9 elements of a rotation";
  io::Get(message.f_cmd_t(), decoded.F_cmd_T);
  if (message.tau_cmd_nm_size() != 0 && !io::Get(message.tau_cmd_nm(), decoded.tau_cmd))
    return "not 7 joint torques";
  if (message.has_input())
    if (const std::string wrong = Get(message.input(), decoded.input); !wrong.empty()) return wrong;
  record = decoded;
  return {};
}

}  // namespace osteon::io
