#pragma once

#include "base/marker.h"
#include "control/setup/servo_params.h"

namespace osteon::control {

/// Speed of the apex beyond which Fault::kToolSpeed is latched [m/s].
///
/// With the admittance law this is 1.1 times the speed limit: the commanded twist keeps the limit, but the
/// joint motion of one tick follows it only up to a second-order error. With the impedance law it is 1.5
/// times the limit: at such a measured speed, the brake has failed to slow the hand down.
[[nodiscard]] inline double ToolSpeedTripLimit_m_per_s(const ServoParams& params) OSTEON_RT {
  return (params.law == Law::kImpedance ? 1.5 : 1.1) * params.twist.max_speed_m_per_s;
}

}  // namespace osteon::control
