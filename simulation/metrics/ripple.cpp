#include "simulation/metrics/ripple.h"

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

namespace osteon::simulation {
namespace {

constexpr std::size_t kMinSamples = 8;

// Subtracts the least-squares line from the signal. Otherwise, a slow change of the mean would leak into the
// lowest bins of the spectrum.
std::vector<double> WithoutTrend(std::span<const double> signal) {
  const auto count = static_cast<double>(signal.size());
  const double middle = 0.5 * (count - 1.0);
  double mean = 0.0, slope = 0.0;
  for (std::size_t i = 0; i < signal.size(); ++i) {
    mean += signal[i] / count;
    slope += (static_cast<double>(i) - middle) * signal[i];
  }
  slope /= count * (count * count - 1.0) / 12.0;  // divided by the sum of (i - middle)^2
  std::vector<double> residual(signal.begin(), signal.end());
  for (std::size_t i = 0; i < residual.size(); ++i)
    residual[i] -= mean + slope * (static_cast<double>(i) - middle);
  return residual;
}

// |X_k|^2 of the signal's DFT at k = bin, with unit_roots[j] = exp(-2 pi i j / N). For sample n, the index j
// = (k n) mod N is computed in integers, so that long signals lose no digits.
double Power(const std::vector<double>& signal, const std::vector<std::complex<double>>& unit_roots,
             std::size_t bin) {
  std::complex<double> sum;
  std::size_t at = 0;
  for (const double value : signal) {
    sum += value * unit_roots[at];
    at += bin;
    if (at >= signal.size()) at -= signal.size();
  }
  return std::norm(sum);
}

}  // namespace

double BandRms(std::span<const double> signal, double rate_hz, Band band) {
  const std::size_t count = signal.size();
  if (count < kMinSamples) return 0.0;
  std::vector<double> windowed = WithoutTrend(signal);
  std::vector<std::complex<double>> unit_roots(count);
  double squared_weights = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
    const double weight = 0.5 - 0.5 * std::cos(angle);
    unit_roots[i] = std::polar(1.0, -angle);
    windowed[i] *= weight;
    squared_weights += weight * weight;
  }
  double power = 0.0;
  for (std::size_t bin = 1; 2 * bin <= count; ++bin) {
    const double hz = static_cast<double>(bin) * rate_hz / static_cast<double>(count);
    if (hz < band.low_hz || hz > band.high_hz) continue;
    power += (2 * bin == count ? 1.0 : 2.0) * Power(windowed, unit_roots, bin);
  }
  return std::sqrt(power / (static_cast<double>(count) * squared_weights));
}

double Ripple::relative() const { return mean_N > 0.0 ? std::hypot(slow_N, fast_N) / mean_N : 0.0; }

Ripple MeasureRipple(std::span<const double> magnitude_N, double rate_hz) {
  Ripple ripple;
  for (const double force : magnitude_N) ripple.mean_N += force / static_cast<double>(magnitude_N.size());
  ripple.slow_N = BandRms(magnitude_N, rate_hz, kSlowRipple);
  ripple.fast_N = BandRms(magnitude_N, rate_hz, kFastRipple);
  return ripple;
}

}  // namespace osteon::simulation
