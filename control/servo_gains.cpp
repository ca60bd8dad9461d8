// ServoLoop's gains, changed while it runs.

#include <stdexcept>
#include <string>

#include "control/servo_loop.h"

namespace osteon::control {

void ServoLoop::RequestGains(const Gains& gains) {
  Validate(gains);
  if (!(gains.max_stiffness_N_per_m <= most_stiffness_N_per_m_))
    throw std::invalid_argument("coupling max_stiffness_N_per_m: found " +
                                std::to_string(gains.max_stiffness_N_per_m) + ", accepted at most " +
                                std::to_string(most_stiffness_N_per_m_) + ", what the loop was made with");
  gains_asked_.Store({.number = ++gains_number_, .gains = gains});
}

// Gains that were asked for since the tick before, and a step of the way to those asked for last.
void ServoLoop::StepGains(TickInput& input) OSTEON_RT {
  const GainsRequest& asked = gains_asked_.Load();
  if (asked.number != gains_taken_) {
    gains_taken_ = asked.number;
    input.has_gains = true;
    input.gains = asked.gains;
    gain_ramp_.Aim(asked.gains);
  }
  if (!gain_ramp_.Step(pressed_)) return;
  const AdmittanceParams before = params_.admittance;
  Lay(gain_ramp_.now(), params_.admittance, params_.coupling);
  wrench_limiter_.Cap(ForceLimit_N(params_));
  if (params_.law == Law::kAdmittance) stabilisers_.Follow(LawOf(params_.admittance, params_));
  if (safety::Renders(state_) && params_.law == Law::kAdmittance)
    V_WT_ = AfterMassChange(before, params_.admittance, arm_->X_WT().linear(), V_WT_);
}

}  // namespace osteon::control
