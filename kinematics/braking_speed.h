#pragma once

#include <cmath>

#include "base/marker.h"

namespace osteon::kinematics {

/// Fastest speed from which a stop with the given deceleration ends within the distance, including one tick
/// at that speed: v dt + v^2 / (2 a) = d. Zero for d <= 0. Use it for a point (distance in m) or a joint
/// (distance in rad).
[[nodiscard]] inline double BrakingSpeed(double distance, double deceleration, double dt_s) OSTEON_RT {
  if (!(distance > 0.0)) return 0.0;
  const double reach = deceleration * dt_s;
  return std::sqrt(reach * reach + 2.0 * deceleration * distance) - reach;
}

}  // namespace osteon::kinematics
