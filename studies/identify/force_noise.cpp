#include "studies/identify/force_noise.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <unsupported/Eigen/FFT>

#include "base/percentile.h"

namespace osteon::studies {
namespace {

// Length of one spectrum's window; least length of a signal.
constexpr double kWindow_s = 1.0, kMinSeconds = 10.0;
constexpr double kLineRatio = 10.0;  // least ratio of a line's power to the median power around it: 10 dB
// Least amplitude of a line: smaller lines come from the resolution of the reading.
constexpr double kMinLine_N = 1e-3;
// Number of frequencies on each side of a line from which the median is taken.
constexpr std::size_t kAround = 10;
constexpr std::size_t kMainLobe = 2;  // half width of a Hann window's main lobe, in frequencies

// Standard deviation of a sample; 0 of fewer than two values.
double SdOf(const std::vector<double>& values) {
  double mean = 0.0, squares = 0.0;
  for (const double value : values) mean += value / static_cast<double>(values.size());
  for (const double value : values) squares += (value - mean) * (value - mean);
  return values.size() > 1 ? std::sqrt(squares / static_cast<double>(values.size() - 1)) : 0.0;
}

// Value i of a Hann window of `window` samples.
double Hann(std::size_t i, std::size_t window) {
  return 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(window));
}

// Mean power of each frequency over the windows, scaled so that a sine of amplitude a gives a^2.
std::vector<double> PowerOf(std::span<const double> force_N, std::size_t window) {
  Eigen::FFT<double> fft;
  std::vector<double> part(window), power(window / 2, 0.0);
  std::vector<std::complex<double>> spectrum;
  const std::size_t windows = force_N.size() / window;
  for (std::size_t k = 0; k < windows; ++k) {
    const auto values = force_N.subspan(k * window, window);
    double mean = 0.0;
    for (const double value : values) mean += value / static_cast<double>(window);
    for (std::size_t i = 0; i < window; ++i) {
      part[i] = Hann(i, window) * (values[i] - mean);
    }
    fft.fwd(spectrum, part);
    for (std::size_t i = 0; i < power.size(); ++i) {
      const double amplitude = 4.0 * std::abs(spectrum[i]) / static_cast<double>(window);
      power[i] += amplitude * amplitude / static_cast<double>(windows);
    }
  }
  return power;
}

// Median power of the frequencies on both sides of `at`, without the main lobe of `at`.
double MedianAround(const std::vector<double>& power, std::size_t at) {
  std::vector<double> around;
  const std::size_t begin = at > kAround + kMainLobe ? at - kAround - kMainLobe : 3;
  for (std::size_t i = begin; i < power.size() && i <= at + kAround + kMainLobe; ++i)
    if (i + kMainLobe < at || i > at + kMainLobe) around.push_back(power[i]);
  return base::Median(around);
}

}  // namespace

ForceNoise MeasureNoise(std::span<const double> force_N, double period_s) {
  ForceNoise noise{.seconds = period_s * static_cast<double>(force_N.size())};
  if (noise.seconds < kMinSeconds) return noise;
  const auto window = static_cast<std::size_t>(std::lround(kWindow_s / period_s));
  std::vector<double> means;
  double squares = 0.0;
  for (std::size_t begin = 0; begin + window <= force_N.size(); begin += window) {
    double mean = 0.0;
    for (std::size_t i = 0; i < window; ++i) mean += force_N[begin + i] / static_cast<double>(window);
    for (std::size_t i = 0; i < window; ++i) squares += std::pow(force_N[begin + i] - mean, 2);
    means.push_back(mean);
  }
  double variance = squares / static_cast<double>(means.size() * (window - 1));

  const std::vector<double> power = PowerOf(force_N, window);
  for (std::size_t i = 3; i < power.size(); ++i) {
    const bool is_peak = power[i] >= power[i - 1] && (i + 1 == power.size() || power[i] > power[i + 1]);
    if (!is_peak || !(power[i] > kLineRatio * MedianAround(power, i)) ||
        !(power[i] > kMinLine_N * kMinLine_N))
      continue;
    noise.lines.push_back({.hz = static_cast<double>(i) / kWindow_s, .amplitude = std::sqrt(power[i])});
    variance -= 0.5 * power[i];  // a sine of amplitude a has the variance a² / 2
  }
  noise.white_N = std::sqrt(std::max(0.0, variance));
  // White noise alone makes the means differ. Remove this part.
  const double drift_N = SdOf(means), by_noise_N = noise.white_N / std::sqrt(static_cast<double>(window));
  noise.drift_N = std::sqrt(std::max(0.0, drift_N * drift_N - by_noise_N * by_noise_N));
  return noise;
}

namespace {

// Power around a harmonic of the rotation. Element i is the sum of the powers at the two frequencies that lie
// i / kTurnWindow_s below and above the harmonic. The force is demodulated by the measured angle, so that a
// changing speed does not spread the harmonic.
std::vector<double> PowerAround(std::span<const double> force_N, std::span<const double> angle_rad, int order,
                                std::size_t window) {
  Eigen::FFT<double> fft;
  std::vector<std::complex<double>> part(window), spectrum;
  std::vector<double> power(window / 2, 0.0);
  for (std::size_t begin = 0; begin + window <= force_N.size(); begin += window / 2) {
    double mean = 0.0;
    for (std::size_t i = 0; i < window; ++i) mean += force_N[begin + i] / static_cast<double>(window);
    for (std::size_t i = 0; i < window; ++i) {
      part[i] =
          Hann(i, window) * (force_N[begin + i] - mean) * std::polar(1.0, -order * angle_rad[begin + i]);
    }
    fft.fwd(spectrum, part);
    power[0] += std::norm(spectrum[0]);
    for (std::size_t i = 1; i < power.size(); ++i)
      power[i] += std::norm(spectrum[i]) + std::norm(spectrum[window - i]);
  }
  return power;
}

// Width around the harmonic that contains 95 % of the power up to element `reach`, after the noise was
// subtracted, as a number of steps of PowerAround; 0 if the harmonic does not stand out of the noise.
double WidthOf(std::vector<double> power, std::size_t reach) {
  // contained share of the power; least ratio of the power to the noise
  constexpr double kContained = 0.95, kStandsOut = 4.0;
  // The harmonic has most of its power in few elements, so the lowest fifth of the elements is taken as
  // noise.
  std::vector<double> sorted(power.begin(), power.begin() + static_cast<std::ptrdiff_t>(reach));
  const double noise_power = base::ValueOfRank(sorted, reach / 5);
  double total = 0.0;
  for (std::size_t i = 0; i < reach; ++i) {
    power[i] = std::max(0.0, power[i] - (i == 0 ? 0.5 : 1.0) * noise_power);
    total += power[i];
  }
  if (!(total > kStandsOut * noise_power * static_cast<double>(kMainLobe + 1))) return 0.0;
  double contained = 0.0;
  for (std::size_t i = 0; i < reach; ++i) {
    contained += power[i];
    if (contained >= kContained * total) return 2.0 * static_cast<double>(std::max<std::size_t>(1, i));
  }
  return 2.0 * static_cast<double>(reach);
}

}  // namespace

double MeasureNotchWidth(std::span<const double> force_N, std::span<const double> speed_rad_per_s,
                         double period_s) {
  // length of one spectrum's window; least length of the signal
  constexpr double kTurnWindow_s = 4.0, kMinTurning_s = 8.0;
  // frequencies between which a harmonic is measured
  constexpr double kLow_hz = 5.0, kHigh_hz = 40.0;
  constexpr int kOrders = 8;
  const std::size_t size = std::min(force_N.size(), speed_rad_per_s.size());
  if (period_s * static_cast<double>(size) < kMinTurning_s) return 0.0;
  std::vector<double> angle_rad(size, 0.0);
  for (std::size_t i = 1; i < size; ++i)
    angle_rad[i] = angle_rad[i - 1] + 0.5 * (speed_rad_per_s[i - 1] + speed_rad_per_s[i]) * period_s;
  const double turn_hz =
      std::abs(angle_rad.back()) / (2.0 * std::numbers::pi * period_s * static_cast<double>(size));
  const auto window = static_cast<std::size_t>(std::lround(kTurnWindow_s / period_s));
  // Half the distance to the next harmonic, which is one rotation frequency away.
  const auto reach = static_cast<std::size_t>(0.5 * turn_hz * kTurnWindow_s);
  if (reach < 4 * kMainLobe) return 0.0;
  double widest_hz = 0.0;
  for (int order = 1; order <= kOrders; ++order)
    if (const double hz = order * turn_hz; hz >= kLow_hz && hz <= kHigh_hz)
      widest_hz =
          std::max(widest_hz, WidthOf(PowerAround(force_N.first(size), angle_rad, order, window), reach) /
                                  kTurnWindow_s);
  return widest_hz;
}

std::vector<SpindleHarmonic> FitSpindleHarmonics(std::span<const double> force_N,
                                                 std::span<const double> speed_rad_per_s, double period_s,
                                                 int orders) {
  const auto size = static_cast<Eigen::Index>(std::min(force_N.size(), speed_rad_per_s.size()));
  const Eigen::Index columns = 1 + 2 * orders;
  if (size <= columns) return {};
  Eigen::MatrixXd basis(size, columns);
  Eigen::VectorXd force(size);
  double angle_rad = 0.0;
  for (Eigen::Index k = 0; k < size; ++k) {
    const auto i = static_cast<std::size_t>(k);
    force[k] = force_N[i];
    basis(k, 0) = 1.0;
    for (int order = 1; order <= orders; ++order) {
      basis(k, 2 * order - 1) = std::cos(order * angle_rad);
      basis(k, 2 * order) = std::sin(order * angle_rad);
    }
    const double next = k + 1 < size ? speed_rad_per_s[i + 1] : speed_rad_per_s[i];
    angle_rad += 0.5 * (speed_rad_per_s[i] + next) * period_s;
  }
  const Eigen::LDLT<Eigen::MatrixXd> normal(basis.transpose() * basis);
  const Eigen::VectorXd fitted = normal.solve(basis.transpose() * force);
  const double variance = (force - basis * fitted).squaredNorm() / static_cast<double>(size - columns);
  std::vector<SpindleHarmonic> harmonics;
  for (int order = 1; order <= orders; ++order)
    harmonics.push_back({.order = order,
                         .amplitude_N = std::hypot(fitted[2 * order - 1], fitted[2 * order]),
                         .half_width_N = 2.0 * std::sqrt(2.0 * variance / static_cast<double>(size))});
  return harmonics;
}

}  // namespace osteon::studies
