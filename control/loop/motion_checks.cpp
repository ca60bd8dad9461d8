#include "control/loop/motion_checks.h"

#include <algorithm>

namespace osteon::control {

using safety::CellEvent, safety::CellState, safety::Fault;

void MotionChecks::CheckArmSpeed(const ArmState& state, bool active) OSTEON_RT {
  const auto& [params, supervisor, session, tool, hand, checks, actions, statistics, result] = parts_;
  const bool commanded = supervisor.MovesOrBrakes() ||
                         (supervisor.state() == CellState::kPaused && session.IsSameActivation(state));
  if (!active || !commanded) {
    checks.ResetArmSpeed();
    return;
  }
  const double limit_m_per_s = supervisor.on_path() && params.start ? params.start->path.tool_speed_m_per_s
                                                                    : ToolSpeedLimit_m_per_s(params, false);
  supervisor.Latch(checks.CheckArmSpeed(state, session.X_WT().translation(), limit_m_per_s));
  result.arm_speed_m_per_s = checks.arm_speed_m_per_s();
  double& peak_m_per_s = statistics.peak_measured_tool_speed_m_per_s;
  peak_m_per_s = std::max(peak_m_per_s, result.arm_speed_m_per_s);
}

void MotionChecks::CheckMotion(const ArmState& state, bool overloaded) OSTEON_RT {
  const auto& [params, supervisor, session, tool, hand, checks, actions, statistics, result] = parts_;
  const CellState cell = supervisor.state();
  const bool paused = cell == CellState::kPaused;
  if (!safety::IsMotion(cell) && cell != CellState::kStop2 && !(paused && session.IsSameActivation(state)))
    return;
  const double error_m = (session.X_WT().translation() - tool.X_WT().translation()).norm();
  statistics.peak_tracking_error_m = std::max(statistics.peak_tracking_error_m, error_m);
  // Under the impedance law, a hand may displace the compliant arm while nothing is rendered: this is no
  // fault.
  const bool compliant = params.law == Law::kImpedance && !safety::IsMotion(cell);
  if (!compliant && !(error_m <= params.max_tracking_error_m)) supervisor.Latch(Fault::kTracking);
  if (state.safety_state != 0 && !paused) supervisor.Latch(Fault::kSession);
  if (overloaded && !paused) supervisor.Latch(Fault::kJointLimit);
  if (supervisor.faults().Any() && !safety::Renders(cell))
    actions.ApplyFault();  // while rendering, HapticRendering applies the fault after its own checks
  if (supervisor.stop_requested()) actions.ApplyEvent(CellEvent::kStopRequested);
  if (supervisor.TakePauseRequest()) actions.ApplyEvent(CellEvent::kPauseRequested);
}

void MotionChecks::CheckOnPath(const TickInputs& tick) OSTEON_RT {
  CheckInStop(tick);
  parts_.supervisor.Latch(parts_.checks.CheckSpindle(tick.readings.spindle, tick.now));
  if (parts_.supervisor.faults().Any()) parts_.actions.ApplyFault();
}

void MotionChecks::CheckInStop(const TickInputs& tick) OSTEON_RT {
  MeasureHand(tick.readings.force);
  parts_.supervisor.Latch(
      parts_.checks.CheckSensor(tick.readings.force, parts_.result.ages.sensor_s, tick.now));
}

Wrench MotionChecks::MeasureHand(const ForceReading& reading) OSTEON_RT {
  const auto& [params, supervisor, session, tool, hand, checks, actions, statistics, result] = parts_;
  const Wrench F_hand_T_W =
      hand.ComputeHandWrench(reading, result.ages.sensor_s, session.X_WT(), session.elapsed_s());
  if (safety::IsFinite(F_hand_T_W)) result.F_hand_T_W = F_hand_T_W;
  supervisor.Latch(checks.CheckHand(F_hand_T_W));
  statistics.peak_sensor_force_N = std::max(statistics.peak_sensor_force_N, checks.hand_N());
  return F_hand_T_W;
}

}  // namespace osteon::control
