#pragma once

#include <complex>

namespace osteon::studies {

/// An arm along one axis, as hil::ServoArm but with any dead time:
///
///     y'' = w^2 (gain u(t - dead) - y) - 2 z w y',   w = 2 pi bandwidth_hz
struct ServoModel {
  double bandwidth_hz{15.0};
  double damping_ratio{1.0};
  double dead_time_s{0.003};
  double gain{1.0};

  /// Delay of slow motion: dead + 2 z / w.
  [[nodiscard]] double lag_s() const;
};

/// Response of the sampled arm: commands u[k] are held for a period, y[k] is the position in the message that
/// the command u[k] answers. Exact for every frequency, by the closed form of a step:
///
///     x[k+1] = E(T) x[k] + E(T - r) (1 - E(r)) c u[k-n-1] + (1 - E(T - r)) c u[k-n],   dead = n T + r
///
/// with E(t) the transition of (y, y') over t, and c = (gain, 0).
[[nodiscard]] std::complex<double> SampledResponse(const ServoModel& model, double period_s, double hz);

}  // namespace osteon::studies
