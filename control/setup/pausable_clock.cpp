#include "control/setup/pausable_clock.h"

#include <algorithm>
#include <cmath>

namespace osteon::control {

// Advances the rate r and its derivative r' by dt_s, with a constant second derivative r''. @returns the
// integral of the rate [s]
double PausableClock::Advance(double dt_s, double acceleration_per_s2) OSTEON_RT {
  const double passed_s = dt_s * (rate_ + dt_s * (rate_speed_ / 2.0 + dt_s * acceleration_per_s2 / 6.0));
  rate_ += dt_s * (rate_speed_ + dt_s * acceleration_per_s2 / 2.0);
  rate_speed_ += dt_s * acceleration_per_s2;
  return passed_s;
}

double PausableClock::Step(double dt_s, bool permitted) OSTEON_RT {
  if (!(dt_s > 0.0) || !std::isfinite(dt_s)) return 0.0;
  const double target = permitted ? 1.0 : 0.0, A = rate_change_per_s2_;

  // Signs are mirrored so that r' falls first: r'' = -A until r' = w, then r'' = +A until r' = 0 at the
  // target.
  const double curve = rate_ - target + rate_speed_ * std::abs(rate_speed_) / (2.0 * A);
  const double sign = curve > 0.0 || (curve == 0.0 && rate_speed_ < 0.0) ? 1.0 : -1.0;
  const double x = sign * (rate_ - target), speed = sign * rate_speed_;
  const double w = -std::sqrt(std::max(0.0, A * x + speed * speed / 2.0));
  const double first_s = std::max(0.0, (speed - w) / A), second_s = -w / A;

  double passed_s = Advance(std::min(dt_s, first_s), -sign * A);
  if (dt_s > first_s) passed_s += Advance(std::min(dt_s - first_s, second_s), sign * A);
  if (dt_s >= first_s + second_s) {
    rate_ = target;
    rate_speed_ = 0.0;
    passed_s += target * (dt_s - first_s - second_s);
  }
  rate_ = std::clamp(rate_, 0.0, 1.0);  // removes rounding errors
  return std::clamp(passed_s, 0.0, dt_s);
}

}  // namespace osteon::control
