#pragma once

#include <array>

#include "control/gains.h"
#include "control/rt/marker.h"

namespace osteon::control {

/// From the gains that act to others, so that the change makes no energy.
///
/// Each gain goes straight to its target within kRampSeconds, with two rules:
///
/// - The coupling's stiffness **rises only while nothing presses** (no plane is penetrated). A spring that is
///   compressed by d and gets stiffer by dK holds dK d^2 / 2 more than was put in; at d = 0 that is nothing,
///   and one that gets softer holds less. So whatever is done to a spring by this rule, never more comes out
///   of it than went in (test StiffnessNeverMakesEnergy).
/// - Mass and inertia change as AfterMassChange says, which the loop applies: kinetic energy never grows.
///
/// Damping, its share and the dead zones store nothing.
class GainRamp {
 public:
  static constexpr double kRampSeconds = 1.0;

  /// @param period_s  of Step, > 0
  GainRamp(const Gains& begin, double period_s) : now_(begin), target_(begin), period_s_(period_s) {}

  /// Where to go from now on. @pre valid gains
  void Aim(const Gains& target) OSTEON_RT;
  /// One tick. @param pressed  the coupling's planes were penetrated in the tick before
  /// @returns whether any gain has changed
  bool Step(bool pressed) OSTEON_RT;

  [[nodiscard]] const Gains& now() const OSTEON_RT { return now_; }

 private:
  Gains now_, target_;
  std::array<double, kGainCount> most_{};  ///< change of each a tick
  double period_s_;
  bool moves_{false};
};

}  // namespace osteon::control
