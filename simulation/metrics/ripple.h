#pragma once

#include <span>

namespace osteon::simulation {

/// A band of frequencies, both ends included.
struct Band {
  double low_hz{0.0}, high_hz{0.0};
};
/// The band in which a hand can follow a force, and the band that a hand feels as texture.
inline constexpr Band kSlowRipple{5.0, 40.0}, kFastRipple{40.0, 500.0};

/// Root mean square of a signal's part within a band.
///
///     w  Hann window, x  signal minus its least-squares line, X = DFT of w x over all N samples
///     rms^2 = 2 / (N sum w^2) sum |X_k|^2    over the bins k with k rate / N in the band (k = N / 2 once)
///
/// A sine of amplitude A well within the band gives A / sqrt 2. The window spreads a sine over three bins, so
/// only a part of a sine that lies within rate / N of the band's end is included. The result is 0 for fewer
/// than 8 samples. Source: Welch, IEEE Trans. Audio Electroacoust. AU-15, 1967 (one segment).
/// @param rate_hz  samples per second, > 0
[[nodiscard]] double BandRms(std::span<const double> signal, double rate_hz, Band band);

/// Variation of a force along a path on which it should be steady.
struct Ripple {
  double mean_N{0.0};
  double slow_N{0.0}, fast_N{0.0};  ///< rms in kSlowRipple and kFastRipple
  /// Rms of both bands together, divided by the mean; 0 if the mean is 0.
  [[nodiscard]] double relative() const;
};
/// Measures the ripple of a force. @param magnitude_N  magnitude of the force, sample by sample
[[nodiscard]] Ripple MeasureRipple(std::span<const double> magnitude_N, double rate_hz);

}  // namespace osteon::simulation
