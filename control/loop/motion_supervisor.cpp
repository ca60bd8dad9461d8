#include "control/loop/motion_supervisor.h"

#include <utility>

namespace osteon::control {

using safety::CellAction, safety::CellEvent, safety::CellState;

CellAction MotionSupervisor::Apply(CellEvent event) OSTEON_RT {
  const safety::CellTransition next = safety::Next(state_, event);
  state_ = next.state;
  moved_ = moved_ || safety::IsMotion(state_);
  if (next.action == CellAction::kHold) on_path_ = false;
  if (next.action == CellAction::kClearFaults) faults_.Clear();
  return next.action;
}

void MotionSupervisor::RequestPause(bool asked) OSTEON_RT {
  pause_requested_ = (pause_requested_ || asked) && (safety::Waits(state_) || safety::IsMotion(state_));
}

bool MotionSupervisor::TakePauseRequest() OSTEON_RT { return std::exchange(pause_requested_, false); }

Phase MotionSupervisor::phase() const OSTEON_RT {
  switch (state_) {
    case CellState::kOff:
      return stop_requested_ ? Phase::kStopped : Phase::kWaiting;
    case CellState::kChecking:
    case CellState::kReady:
    case CellState::kRecovery:
    case CellState::kPaused:
      return Phase::kWaiting;
    case CellState::kAligning:
      return Phase::kAligning;
    case CellState::kHaptic:
    case CellState::kCutting:
      return Phase::kHaptic;
    case CellState::kStop1:
    case CellState::kStop2:
      return on_path_ ? Phase::kAligning : Phase::kStopping;
    case CellState::kStop0:
    case CellState::kFault:
      break;
  }
  return Phase::kStopped;
}

bool MotionSupervisor::CanRecover() const OSTEON_RT {
  return !stop_requested_ && safety::Next(state_, CellEvent::kRecover).state == CellState::kRecovery &&
         safety::AllowsRecovery(faults_);
}

}  // namespace osteon::control
