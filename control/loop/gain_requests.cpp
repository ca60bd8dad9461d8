#include "control/loop/gain_requests.h"

#include <stdexcept>
#include <string>

#include "base/number_text.h"

namespace osteon::control {

GainRequests::GainRequests(const Gains& gains, double period_s)
    : max_stiffness_N_per_m_(gains.max_stiffness_N_per_m), ramp_(gains, period_s) {}

void GainRequests::Request(const Gains& gains) {
  Validate(gains);
  if (!(gains.max_stiffness_N_per_m <= max_stiffness_N_per_m_))
    throw std::invalid_argument("coupling max_stiffness_N_per_m: found " +
                                base::NumberText(gains.max_stiffness_N_per_m) + ", accepted at most " +
                                base::NumberText(max_stiffness_N_per_m_) + ", what the loop was made with");
  requested_.Store({.number = ++requests_, .gains = gains});
}

bool GainRequests::Step(bool pressed, TickInput& input) OSTEON_RT {
  const Requested& requested = requested_.Load();
  if (requested.number != taken_) {
    taken_ = requested.number;
    input.has_gains = true;
    input.gains = requested.gains;
    ramp_.SetTarget(requested.gains);
  }
  return ramp_.Step(pressed);
}

}  // namespace osteon::control
