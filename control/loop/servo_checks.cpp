// ServoLoop's checks of the arm, the hand and the devices while nothing is rendered.

#include <algorithm>

#include "control/loop/servo_loop.h"

namespace osteon::control {

using safety::CellEvent, safety::CellState, safety::Fault;

// Checks the measured speed of the arm while the loop commands it. The path to the start has a speed limit of
// its own.
void ServoLoop::CheckArmSpeed(const ArmState& state, bool active) OSTEON_RT {
  const bool commanded = supervisor_.MovesOrBrakes() ||
                         (this->state() == CellState::kPaused && session_.IsSameActivation(state));
  if (!active || !commanded) {
    checks_.ResetArmSpeed();
    return;
  }
  const double limit_m_per_s = supervisor_.on_path() && params_.start
                                   ? params_.start->path.tool_speed_m_per_s
                                   : ToolSpeedLimit_m_per_s(params_, false);
  supervisor_.Latch(checks_.CheckArmSpeed(state, session_.X_WT().translation(), limit_m_per_s));
  result_.arm_speed_m_per_s = checks_.arm_speed_m_per_s();
  double& peak_m_per_s = statistics_.peak_measured_tool_speed_m_per_s;
  peak_m_per_s = std::max(peak_m_per_s, result_.arm_speed_m_per_s);
}

// Ends a motion if the arm is too far from its command, has stopped by itself, or has overloaded joints, or
// if a stop or a pause was requested.
void ServoLoop::CheckMotion(const ArmState& state) OSTEON_RT {
  const bool paused = this->state() == CellState::kPaused;
  if (!safety::IsMotion(this->state()) && this->state() != CellState::kStop2 &&
      !(paused && session_.IsSameActivation(state)))
    return;
  const double error_m = (session_.X_WT().translation() - tool_.X_WT().translation()).norm();
  statistics_.peak_tracking_error_m = std::max(statistics_.peak_tracking_error_m, error_m);
  // under the impedance law the arm is compliant: a hand may displace it while nothing is rendered
  const bool compliant = params_.law == Law::kImpedance && !safety::IsMotion(this->state());
  if (!compliant && !(error_m <= params_.max_tracking_error_m)) supervisor_.Latch(Fault::kTracking);
  if (state.safety_state != 0 && !paused) supervisor_.Latch(Fault::kSession);
  if (arm_overloaded_ && !paused) supervisor_.Latch(Fault::kJointLimit);
  if (faults().Any() && !safety::Renders(this->state()))
    actions_.ApplyFault();  // rendering checks more before it stops
  if (supervisor_.stop_requested()) actions_.ApplyEvent(CellEvent::kStopRequested);
  if (supervisor_.TakePauseRequest()) actions_.ApplyEvent(CellEvent::kPauseRequested);
}

// Checks sensor, spindle and hand on the path to the start. Nothing is rendered there, so the model's age is
// not checked; without the PLC's permission the path is paused (MotionStart::StepPath).
void ServoLoop::CheckOnPath(const TickInputs& tick) OSTEON_RT {
  CheckInStop(tick);
  supervisor_.Latch(checks_.CheckSpindle(tick.readings.spindle, tick.now));
  if (faults().Any()) actions_.ApplyFault();
}

// Checks hand and sensor while the arm brakes to rest. Spindle and PLC are not checked: they are stopping as
// well.
void ServoLoop::CheckInStop(const TickInputs& tick) OSTEON_RT {
  MeasureHand(tick.readings.force);
  supervisor_.Latch(checks_.CheckSensor(tick.readings.force, result_.ages.sensor_s, tick.now));
}

// Computes the hand's wrench on the tool, zero if no reading can be trusted, and checks it.
Wrench ServoLoop::MeasureHand(const ForceReading& reading) OSTEON_RT {
  const Wrench F_hand_T_W =
      hand_.ComputeHandWrench(reading, result_.ages.sensor_s, session_.X_WT(), session_.elapsed_s());
  if (safety::IsFinite(F_hand_T_W)) result_.F_hand_T_W = F_hand_T_W;
  supervisor_.Latch(checks_.CheckHand(F_hand_T_W));
  statistics_.peak_sensor_force_N = std::max(statistics_.peak_sensor_force_N, checks_.hand_N());
  return F_hand_T_W;
}

}  // namespace osteon::control
