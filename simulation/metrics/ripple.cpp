#include "simulation/metrics/ripple.h"

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

namespace osteon::simulation {
namespace {

constexpr std::size_t kMinSamples = 8;

// Subtracts the least-squares line: a slow change of the mean would leak into the lowest bins.
std::vector<double> WithoutTrend(std::span<const double> signal) {
  const auto count = static_cast<double>(signal.size());
  const double middle = 0.5 * (count - 1.0);
  double mean = 0.0, slope = 0.0;
  for (std::size_t i = 0; i < signal.size(); ++i) {
    mean += signal[i] / count;
    slope += (static_cast<double>(i) - middle) * signal[i];
  }
  slope /= count * (count * count - 1.0) / 12.0;  // sum of (i - middle)^2
  std::vector<double> left(signal.begin(), signal.end());
  for (std::size_t i = 0; i < left.size(); ++i) left[i] -= mean + slope * (static_cast<double>(i) - middle);
  return left;
}

// |X_k|^2. The angle is reduced in whole numbers, so that long signals lose no digits.
double Power(const std::vector<double>& signal, const std::vector<std::complex<double>>& turn,
             std::size_t bin) {
  std::complex<double> sum;
  std::size_t at = 0;
  for (const double value : signal) {
    sum += value * turn[at];
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
  std::vector<std::complex<double>> turn(count);
  double squares = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
    const double weight = 0.5 - 0.5 * std::cos(angle);
    turn[i] = std::polar(1.0, -angle);
    windowed[i] *= weight;
    squares += weight * weight;
  }
  double power = 0.0;
  for (std::size_t bin = 1; 2 * bin <= count; ++bin) {
    const double hz = static_cast<double>(bin) * rate_hz / static_cast<double>(count);
    if (hz < band.low_hz || hz > band.high_hz) continue;
    power += (2 * bin == count ? 1.0 : 2.0) * Power(windowed, turn, bin);
  }
  return std::sqrt(power / (static_cast<double>(count) * squares));
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
