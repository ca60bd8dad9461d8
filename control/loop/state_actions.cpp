#include "control/loop/state_actions.h"

namespace osteon::control {

using safety::CellAction, safety::CellEvent;

CellAction StateActions::ApplyEvent(CellEvent event) OSTEON_RT {
  const CellAction action = parts_.supervisor.Apply(event);
  if (action == CellAction::kHold) parts_.tool.HoldStill();
  if (action == CellAction::kBrake) {
    parts_.tool.StartBraking();
    parts_.impedance.StartBraking();
  }
  return action;
}

void StateActions::StopWith(safety::Fault fault) OSTEON_RT {
  parts_.supervisor.Latch(fault);
  ApplyFault();
}

void StateActions::FinishStop() OSTEON_RT {
  ApplyEvent(parts_.supervisor.faults().Any() ? CellEvent::kRestFault : CellEvent::kRest);
}

void StateActions::Brake(bool reduced_speed, safety::LimitSet& acting) OSTEON_RT {
  if (parts_.params.law == Law::kImpedance) {
    if (parts_.impedance.Brake(parts_.session, parts_.coupling.limiter(), parts_.tool)) FinishStop();
    return;
  }
  const BrakingStep step = parts_.tool.Brake(ElbowSpeedLimit_m_per_s(parts_.params, reduced_speed));
  acting.Add(step.acting);
  parts_.supervisor.Latch(step.fault);
  if (step.at_rest) FinishStop();
}

void StateActions::BrakeJoints() OSTEON_RT {
  if (parts_.tool.BrakeJoints()) FinishStop();
}

}  // namespace osteon::control
