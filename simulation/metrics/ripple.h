#pragma once

#include <span>

namespace osteon::simulation {

/// A band of frequencies, both ends included.
struct Band {
  double low_hz{0.0}, high_hz{0.0};
};
/// What a hand can follow, and what it feels as texture.
inline constexpr Band kSlowRipple{5.0, 40.0}, kFastRipple{40.0, 500.0};

/// Root mean square of that part of a signal which lies in a band.
///
///     w  Hann window, x less its straight line of least squares, X = DFT of w x over all N samples
///     rms^2 = 2 / (N sum w^2) sum |X_k|^2    over the bins k rate / N within the band (N / 2, the last, once)
///
/// A sine of amplitude A well within the band gives A / sqrt 2; the window spreads it over three bins, so
/// that a sine within rate / N of the band's end counts in part. Zero where there are fewer than 8 samples.
/// Source: Welch, IEEE Trans. Audio Electroacoust. AU-15, 1967 (one segment).
/// @param rate_hz  of the samples, > 0
[[nodiscard]] double BandRms(std::span<const double> signal, double rate_hz, Band band);

/// How much a force trembles along a path that should give a steady one.
struct Ripple {
  double mean_N{0.0};
  double slow_N{0.0}, fast_N{0.0};  ///< rms in kSlowRipple and kFastRipple
  /// Both bands together over the mean; 0 where there is no mean.
  [[nodiscard]] double relative() const;
};
/// @param magnitude_N  of the force, sample by sample
[[nodiscard]] Ripple MeasureRipple(std::span<const double> magnitude_N, double rate_hz);

}  // namespace osteon::simulation
