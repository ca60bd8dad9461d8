#include "control/loop/tick_input.h"

namespace osteon::control {

TickInput MakeTickInput(const TickInputs& tick, bool stop) OSTEON_RT {
  const auto& [state, received, readings, model, now] = tick;
  return {.now = now,
          .arm_stamp = state.stamp,
          .sequence = state.sequence,
          .activation = state.activation,
          .lost = state.lost,
          .duplicate = state.duplicate,
          .late = state.late,
          .reordered = state.reordered,
          .rejected = state.rejected,
          .other_version = state.other_version,
          .answers_lost = state.answers_lost,
          .answers_foreign = state.answers_foreign,
          .quality = state.quality,
          .safety_state = state.safety_state,
          .operation_mode = state.operation_mode,
          .control_mode = static_cast<std::uint8_t>(state.control_mode),
          .command_mode = static_cast<std::uint8_t>(state.command_mode),
          .drives_active = state.drives_active,
          .holding = state.holding,
          .has_ipo = state.has_ipo,
          .received = static_cast<std::uint8_t>(received),
          .stop = stop,
          .model_status = static_cast<std::uint8_t>(model.status),
          .period_s = state.period_s,
          .q_ipo = state.q_ipo,
          .tau_ext = state.tau_ext,
          .sensor_stamp = readings.force.stamp,
          .F_sensor_S = readings.force.F_S,
          .sensor_trusted = readings.force.trusted,
          .spindle_stamp = readings.spindle.stamp,
          .spindle_meas_rad_per_s = readings.spindle.speed_rad_per_s,
          .spindle_torque_Nm = readings.spindle.torque_Nm,
          .spindle_ready = readings.spindle.ready,
          .spindle_fault = readings.spindle.fault,
          .drive_faults = readings.spindle.faults,
          .drive_nmt_state = readings.spindle.nmt_state,
          .drive_emergency_code = readings.spindle.emergency_code,
          .drive_error_code = readings.spindle.error_code,
          .interlock_stamp = readings.interlock.stamp,
          .permitted = readings.interlock.permitted,
          .enabled = readings.interlock.enabled,
          .spindle_permitted = readings.interlock.spindle_permitted,
          .interlock_reason = readings.interlock.reason,
          .model_pose_stamp = model.pose_stamp};
}

ArmState ArmStateOf(const TickRecord& tick) OSTEON_RT {
  const TickInput& in = tick.input;
  return {.stamp = in.arm_stamp,
          .sequence = in.sequence,
          .session = static_cast<SessionState>(tick.session_state),
          .quality = in.quality,
          .safety_state = in.safety_state,
          .operation_mode = in.operation_mode,
          .drives_active = in.drives_active,
          .control_mode = static_cast<ControlMode>(in.control_mode),
          .command_mode = static_cast<CommandMode>(in.command_mode),
          .period_s = in.period_s,
          .q_meas = tick.q_meas,
          .q_ipo = in.q_ipo,
          .has_ipo = in.has_ipo,
          .tau_ext = in.tau_ext,
          .activation = in.activation,
          .holding = in.holding,
          .lost = in.lost,
          .duplicate = in.duplicate,
          .late = in.late,
          .reordered = in.reordered,
          .rejected = in.rejected,
          .other_version = in.other_version,
          .answers_lost = in.answers_lost,
          .answers_foreign = in.answers_foreign};
}

CellReadings CellReadingsOf(const TickInput& input) OSTEON_RT {
  return {.force = {.stamp = input.sensor_stamp, .F_S = input.F_sensor_S, .trusted = input.sensor_trusted},
          .spindle = {.stamp = input.spindle_stamp,
                      .speed_rad_per_s = input.spindle_meas_rad_per_s,
                      .torque_Nm = input.spindle_torque_Nm,
                      .ready = input.spindle_ready,
                      .fault = input.spindle_fault,
                      .faults = input.drive_faults,
                      .nmt_state = input.drive_nmt_state,
                      .emergency_code = input.drive_emergency_code,
                      .error_code = input.drive_error_code},
          .interlock = {.stamp = input.interlock_stamp,
                        .permitted = input.permitted,
                        .enabled = input.enabled,
                        .spindle_permitted = input.spindle_permitted,
                        .reason = input.interlock_reason}};
}

}  // namespace osteon::control
