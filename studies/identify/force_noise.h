#pragma once

#include <span>
#include <vector>

namespace osteon::studies {

/// A line of a spectrum that stands out.
struct NoiseLine {
  double hz{0.0};
  double amplitude{0.0};  ///< of the sine, in the signal's unit
};

/// What a force sensor reads at rest, along one direction.
struct ForceNoise {
  double white_N{0.0};  ///< standard deviation within a second, without the lines
  double drift_N{0.0};  ///< standard deviation of means over 1 s
  std::vector<NoiseLine> lines{};
  double seconds{0.0};

  /// A dead zone that the drift does not pass: 3 drift_N.
  [[nodiscard]] double dead_zone_N() const { return 3.0 * drift_N; }
};

/// Measures a signal at rest: drift from means over 1 s, noise and lines from spectra of 1 s windows (Hann),
/// where a line stands 10 dB above the median of the 20 frequencies around it.
/// @param force_N  one value a period, 10 s or more; shorter: zeros
[[nodiscard]] ForceNoise MeasureNoise(std::span<const double> force_N, double period_s);

/// One harmonic of a turning tool in the force.
struct SpindleHarmonic {
  int order{1};
  double amplitude_N{0.0};
  double half_width_N{0.0};  ///< of its 95 % interval
};

/// Least squares of the harmonics 1 … orders of the spindle's turn in a force, on the integrated measured
/// speed: wander of the speed does not blur them, as it does at a nominal speed.
/// @param speed_rad_per_s  measured, one value a period  @pre both of one length
[[nodiscard]] std::vector<SpindleHarmonic> FitSpindleHarmonics(std::span<const double> force_N,
                                                               std::span<const double> speed_rad_per_s,
                                                               double period_s, int orders = 8);

/// Width in Hz of a notch around a harmonic of the spindle's measured turn that holds 95 % of that harmonic's
/// power, without the noise beside it; the widest of the harmonics 1 … 8 between 5 and 40 Hz that stand out
/// of their noise. A resolution of 0.25 Hz.
/// @returns 0 if no harmonic stands out, or with less than 8 s
[[nodiscard]] double MeasureNotchWidth(std::span<const double> force_N,
                                       std::span<const double> speed_rad_per_s, double period_s);

}  // namespace osteon::studies
