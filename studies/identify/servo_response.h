#pragma once

#include <complex>

namespace osteon::studies {

/// Model of an arm along one axis, as in hil::ServoArm but with any dead time:
///
///     y'' = w^2 (gain u(t - dead) - y) - 2 z w y',   w = 2 pi bandwidth_hz
///
/// with the position y, the command u, the damping ratio z and the dead time `dead`.
struct ServoModel {
  double bandwidth_hz{15.0};
  double damping_ratio{1.0};
  double dead_time_s{0.003};
  double gain{1.0};

  /// Delay of slow motion: dead + 2 z / w.
  [[nodiscard]] double lag_s() const;
};

/// Response of the sampled arm: each command u[k] is held for a period T; y[k] is the position in the message
/// that the command u[k] answers. It is exact for every frequency, by the closed form of a step of the state
/// x = (y, y'):
///
///     x[k+1] = E(T) x[k] + E(T - r) (1 - E(r)) c u[k-n-1] + (1 - E(T - r)) c u[k-n],   dead = n T + r
///
/// with the whole periods n and the rest r of the dead time, the transition matrix E(t) of x over a time t,
/// and c = (gain, 0).
[[nodiscard]] std::complex<double> SampledResponse(const ServoModel& model, double period_s, double hz);

}  // namespace osteon::studies
