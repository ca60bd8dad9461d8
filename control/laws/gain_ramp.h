#pragma once

#include <array>

#include "base/marker.h"
#include "control/laws/gains.h"

namespace osteon::control {

/// Moves the acting gains to their targets without creating energy.
///
/// Each gain moves linearly to its target within kRampSeconds. Two rules apply:
///
/// - The coupling's stiffness **rises only while no plane is penetrated**. If the stiffness of a spring that
///   is compressed by d rises by dK, the spring stores dK d^2 / 2 more energy than was put in; at d = 0 this
///   is zero. If a spring gets softer, it stores less. So the spring never returns more energy than was put
///   in (test StiffnessNeverMakesEnergy).
/// - When mass and inertia change, the loop changes the velocity by AfterMassChange, so that kinetic energy
///   never grows.
///
/// Damping, its share and the dead zones store no energy, so no rule is needed for them.
class GainRamp {
 public:
  static constexpr double kRampSeconds = 1.0;

  /// @param begin  the acting gains at the beginning @param period_s  period of Step, > 0
  GainRamp(const Gains& begin, double period_s) : now_(begin), target_(begin), period_s_(period_s) {}

  /// Sets the target gains. @pre valid gains
  void SetTarget(const Gains& target) OSTEON_RT;
  /// Advances the ramp by one tick.
  /// @param pressed  whether a plane of the coupling was penetrated in the previous tick
  /// @returns whether any gain has changed
  bool Step(bool pressed) OSTEON_RT;

  /// The acting gains.
  [[nodiscard]] const Gains& now() const OSTEON_RT { return now_; }

 private:
  Gains now_, target_;
  std::array<double, kGainCount> max_step_{};  ///< largest change of each gain in a tick
  double period_s_;
  bool moves_{false};
};

}  // namespace osteon::control
