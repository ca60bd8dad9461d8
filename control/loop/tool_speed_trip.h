#pragma once

#include "base/marker.h"
#include "control/setup/servo_params.h"

namespace osteon::control {

/// Speed of the apex beyond which Fault::kToolSpeed is latched [m/s]. For a commanded tool 1.1 times the
/// limit: a pull-back through the joints may leave the straight line by second order. For a measured tool
/// (impedance) 1.5 times the limit: beyond it the brake has failed to hold the hand.
[[nodiscard]] inline double ToolSpeedTripLimit_m_per_s(const ServoParams& params) OSTEON_RT {
  return (params.law == Law::kImpedance ? 1.5 : 1.1) * params.twist.max_speed_m_per_s;
}

}  // namespace osteon::control
