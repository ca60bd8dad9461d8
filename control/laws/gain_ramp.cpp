#include "control/laws/gain_ramp.h"

#include <algorithm>
#include <cmath>

namespace osteon::control {
namespace {

// The gains' values, in the order of VisitGains.
std::array<double, kGainCount> GainValues(const Gains& gains) {
  std::array<double, kGainCount> numbers{};
  std::size_t i = 0;
  VisitGains(gains, [&](const char*, const char*, const char*, double value) { numbers[i++] = value; });
  return numbers;
}

}  // namespace

void GainRamp::SetTarget(const Gains& target) OSTEON_RT {
  target_ = target;
  moves_ = true;
  const std::array<double, kGainCount> from = GainValues(now_), to = GainValues(target);
  for (std::size_t i = 0; i < kGainCount; ++i)
    max_step_[i] = std::abs(to[i] - from[i]) * std::min(1.0, period_s_ / kRampSeconds);
}

bool GainRamp::Step(bool pressed) OSTEON_RT {
  if (!moves_) return false;
  const std::array<double, kGainCount> to = GainValues(target_);
  bool changed = false, all_reached = true;
  std::size_t i = 0;
  VisitGains(now_, [&](const char*, const char*, const char*, double& value) {
    const bool rising_spring = &value == &now_.max_stiffness_N_per_m && to[i] > value;
    if (value != to[i] && !(rising_spring && pressed)) {
      // The last step may exceed the largest step by a rounding error: otherwise the ramp would need a
      // further step.
      value = std::abs(to[i] - value) <= (1.0 + 1e-6) * max_step_[i]
                  ? to[i]
                  : value + std::copysign(max_step_[i], to[i] - value);
      changed = true;
    }
    all_reached &= value == to[i];
    ++i;
  });
  moves_ = !all_reached;
  return changed;
}

}  // namespace osteon::control
