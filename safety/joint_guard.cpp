#include "safety/joint_guard.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "base/number_text.h"
#include "safety/limits.h"

namespace osteon::safety {

template <int N>
JointGuard<N>::JointGuard(const JointGuardParams& params) : params_(params) {
  const auto positive = [](double value) { return std::isfinite(value) && value > 0.0; };
  for (std::size_t i = 0; i < static_cast<std::size_t>(N); ++i) {
    const kinematics::JointLimits& limit = params.limits[i];
    if (!std::isfinite(limit.lower_rad) || !std::isfinite(limit.upper_rad) ||
        !(limit.lower_rad < limit.upper_rad) || !positive(limit.velocity_rad_per_s) ||
        !positive(limit.acceleration_rad_per_s2))
      throw std::invalid_argument("joint A" + std::to_string(i + 1) + ": found positions " +
                                  base::NumberText(limit.lower_rad) + " … " +
                                  base::NumberText(limit.upper_rad) + " rad, velocity " +
                                  base::NumberText(limit.velocity_rad_per_s) + " rad/s, acceleration " +
                                  base::NumberText(limit.acceleration_rad_per_s2) +
                                  " rad/s^2, accepted lower < upper and > 0 for the others");
    if (!(params.position_margin_rad >= 0.0 &&
          params.position_margin_rad < 0.5 * (limit.upper_rad - limit.lower_rad)))
      throw std::invalid_argument("position_margin_rad: found " +
                                  base::NumberText(params.position_margin_rad) +
                                  ", accepted 0 … below half of every joint's range");
  }
  if (!(params.speed_share > 0.0 && params.speed_share <= 1.0))
    throw std::invalid_argument("speed_share: found " + base::NumberText(params.speed_share) +
                                ", accepted 0 … 1");
  if (!positive(params.jump_rad))
    throw std::invalid_argument("jump_rad: found " + base::NumberText(params.jump_rad) + ", accepted > 0");
}

template <int N>
typename JointGuard<N>::Result JointGuard<N>::Limit(const Joints& q, const Joints& wanted_step_rad,
                                                    double dt_s) const OSTEON_RT {
  Result result;
  for (int i = 0; i < N; ++i) {
    const kinematics::JointLimits& limit = params_.limits[static_cast<std::size_t>(i)];
    const double step = wanted_step_rad[i];
    if (!std::isfinite(q[i]) || !(std::abs(step) <= params_.jump_rad)) {
      result.jump = true;
      result.share = 0.0;
      return result;
    }
    if (q[i] > limit.upper_rad || q[i] < limit.lower_rad) result.violated = true;

    // distance to the position limit in the step's direction
    const bool down = std::signbit(step);
    const double distance = down ? -limit.lower_rad - params_.position_margin_rad + q[i]
                                 : limit.upper_rad - params_.position_margin_rad - q[i];
    const double speed = std::min(params_.speed_share * limit.velocity_rad_per_s,
                                  BrakingSpeed(distance, limit.acceleration_rad_per_s2, dt_s));
    if (std::abs(step) > speed * dt_s) result.share = std::min(result.share, speed * dt_s / std::abs(step));
  }
  result.step = result.share * wanted_step_rad;
  return result;
}

template class JointGuard<6>;
template class JointGuard<7>;

}  // namespace osteon::safety
