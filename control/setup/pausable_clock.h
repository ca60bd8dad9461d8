#pragma once

#include "base/marker.h"

namespace osteon::control {

/// A clock that runs while permitted, and stops and restarts smoothly. Its rate r, 0 at rest and 1 in step
/// with real time, reaches its target in the least time that a bounded second derivative allows:
///
///     |r''| <= A = 9 / pause^2        r'' = -A sign(x + r'|r'| / 2A), x = r - target
///
/// Therefore 0 <= r <= 1 and |r'| <= sqrt(A) = 3 / pause; r and r' are continuous. From r = 1 the clock stops
/// within 2/3 pause. In the worst case (permission withdrawn while r' is largest) it stops within pause. Each
/// step is integrated exactly, including a change of the sign of r'' within the step. The clock begins at
/// rest. Source of the switching curve: Athans and Falb, Optimal Control, 1966, 7-2 (the double integrator).
class PausableClock {
 public:
  /// @param pause_s  longest time from the end of the permission to rest. The caller must check that the time
  ///   is > 0 and finite.
  explicit PausableClock(double pause_s) OSTEON_RT : rate_change_per_s2_(9.0 / (pause_s * pause_s)) {}

  /// @param dt_s  real time that passes; a value that is not > 0 counts as none
  /// @returns the integral of r over the step: the time by which this clock advances [s], 0 … dt_s
  [[nodiscard]] double Step(double dt_s, bool permitted) OSTEON_RT;

  [[nodiscard]] double rate() const OSTEON_RT { return rate_; }
  /// Largest |r'| [1/s] for a given pause.
  [[nodiscard]] static double MaxRateSpeed(double pause_s) OSTEON_RT { return 3.0 / pause_s; }

 private:
  [[nodiscard]] double Advance(double dt_s, double acceleration_per_s2) OSTEON_RT;

  double rate_change_per_s2_;  // A
  double rate_{0.0};           // r
  double rate_speed_{0.0};     // r' [1/s]
};

}  // namespace osteon::control
