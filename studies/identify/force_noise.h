#pragma once

#include <span>
#include <vector>

namespace osteon::studies {

/// A narrow peak of a spectrum.
struct NoiseLine {
  double hz{0.0};
  double amplitude{0.0};  ///< amplitude of the sine, in the signal's unit
};

/// The noise and drift of a force sensor at rest, along one direction.
struct ForceNoise {
  double white_N{0.0};  ///< standard deviation within a second, without the lines
  double drift_N{0.0};  ///< standard deviation of means over 1 s
  std::vector<NoiseLine> lines{};
  double seconds{0.0};

  /// Dead zone that covers the drift: 3 drift_N.
  [[nodiscard]] double dead_zone_N() const { return 3.0 * drift_N; }
};

/// Measures a signal at rest. Drift follows from means over 1 s, noise and lines from spectra of 1 s windows
/// (Hann). A line is at least 10 dB above the median of the 20 frequencies around it.
/// @param force_N  one value per period, at least 10 s
/// @returns zeros if the signal is shorter
[[nodiscard]] ForceNoise MeasureNoise(std::span<const double> force_N, double period_s);

/// One harmonic of the spindle's rotation in the measured force.
struct SpindleHarmonic {
  int order{1};
  double amplitude_N{0.0};
  double half_width_N{0.0};  ///< half width of the amplitude's 95 % interval
};

/// Fits the harmonics 1 … `orders` of the spindle's rotation to a force, by least squares. The rotation angle
/// is the integral of the measured speed: so a changing speed does not blur the harmonics, as it would with a
/// nominal speed.
/// @param speed_rad_per_s  measured, one value per period  @pre force and speed have the same length
[[nodiscard]] std::vector<SpindleHarmonic> FitSpindleHarmonics(std::span<const double> force_N,
                                                               std::span<const double> speed_rad_per_s,
                                                               double period_s, int orders = 8);

/// Returns the width in Hz that a notch around a harmonic of the spindle's rotation needs to contain 95 % of
/// the harmonic's power, without the noise beside it. It is the largest width over those of the harmonics 1 …
/// 8 that lie between 5 and 40 Hz and stand out of the noise. The resolution is 0.25 Hz.
/// @returns 0 if no harmonic stands out, or if the signal is shorter than 8 s
[[nodiscard]] double MeasureNotchWidth(std::span<const double> force_N,
                                       std::span<const double> speed_rad_per_s, double period_s);

}  // namespace osteon::studies
