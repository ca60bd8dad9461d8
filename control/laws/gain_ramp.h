#pragma once

#include <array>

#include "base/marker.h"
#include "control/laws/gains.h"

namespace osteon::control {

/// Changes the acting gains to others without creating energy.
///
/// Each gain moves linearly to its target within kRampSeconds, with two rules:
///
/// - The coupling's stiffness **rises only while nothing presses** (no plane is penetrated). A spring that is
/// compressed by d and gets stiffer by dK stores dK d^2 / 2 more than was put in; at d = 0 this is zero, and
/// a spring that gets softer stores less. Under this rule a spring never returns more energy than was put in
/// (test StiffnessNeverMakesEnergy).
/// - Mass and inertia change as AfterMassChange says, which the loop applies: kinetic energy never grows.
///
/// Damping, its share and the dead zones store no energy.
class GainRamp {
 public:
  static constexpr double kRampSeconds = 1.0;

  /// @param period_s  of Step, > 0
  GainRamp(const Gains& begin, double period_s) : now_(begin), target_(begin), period_s_(period_s) {}

  /// Sets the gains to go to from now on. @pre valid gains
  void SetTarget(const Gains& target) OSTEON_RT;
  /// One tick. @param pressed  the coupling's planes were penetrated in the tick before
  /// @returns whether any gain has changed
  bool Step(bool pressed) OSTEON_RT;

  [[nodiscard]] const Gains& now() const OSTEON_RT { return now_; }

 private:
  Gains now_, target_;
  std::array<double, kGainCount> max_step_{};  ///< largest change of each gain in a tick
  double period_s_;
  bool moves_{false};
};

}  // namespace osteon::control
