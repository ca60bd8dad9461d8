#include "procedure/assessment/tremor.h"

#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>

namespace osteon::procedure {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;  // [rad]

// Whether a frequency is within kNotch_hz of a multiple of the spindle's speed. Always false for a spindle
// slower than kNotch_hz, since its multiples would cover every frequency.
bool IsSpindleHarmonic(double frequency_hz, double spindle_hz) {
  if (spindle_hz < TremorMeter::kNotch_hz) return false;
  const double harmonic = std::round(frequency_hz / spindle_hz);
  return harmonic >= 1.0 && std::abs(frequency_hz - harmonic * spindle_hz) < TremorMeter::kNotch_hz;
}

}  // namespace

TremorMeter::TremorMeter(double period_s)
    : period_s_(period_s), window_(static_cast<std::size_t>(std::lround(kWindow_s / period_s))) {
  samples_.reserve(window_);
  spindle_rad_per_s_.reserve(window_);
}

void TremorMeter::Add(const Vector3& force_N, double spindle_rad_per_s) {
  samples_.push_back(force_N);
  spindle_rad_per_s_.push_back(spindle_rad_per_s);
  if (samples_.size() < window_) return;
  AddWindow();
  const auto half = static_cast<std::ptrdiff_t>(window_ / 2);
  samples_.erase(samples_.begin(), samples_.begin() + half);
  spindle_rad_per_s_.erase(spindle_rad_per_s_.begin(), spindle_rad_per_s_.begin() + half);
}

// Adds the mean square of the newest window between kLow_hz and kHigh_hz. By Parseval's theorem, for the
// one-sided spectrum of a window with weights w and N samples, it is 2 / (N sum w²) times the sum of |X_k|²
// over the band.
void TremorMeter::AddWindow() {
  const auto n = static_cast<double>(window_);
  double weight_squares = 0.0, spindle_rad_per_s = 0.0;
  std::vector<double> weight(window_);
  for (std::size_t i = 0; i < window_; ++i) {
    weight[i] = 0.5 - 0.5 * std::cos(kTurn * static_cast<double>(i) / n);
    weight_squares += weight[i] * weight[i];
    spindle_rad_per_s += spindle_rad_per_s_[i] / n;
  }
  const double line_hz = 1.0 / (n * period_s_);
  for (int k = static_cast<int>(std::ceil(kLow_hz / line_hz)); k * line_hz <= kHigh_hz; ++k) {
    if (IsSpindleHarmonic(k * line_hz, spindle_rad_per_s / kTurn)) continue;
    // X_k as a sum over samples; the phase factor is multiplied by `turn` from sample to sample
    const std::complex<double> turn = std::polar(1.0, -kTurn * k / n);
    std::complex<double> phase = 1.0;
    Eigen::Vector3cd sum = Eigen::Vector3cd::Zero();
    for (std::size_t i = 0; i < window_; ++i, phase *= turn) sum += weight[i] * phase * samples_[i];
    power_N2_ += 2.0 / (n * weight_squares) * sum.squaredNorm();
  }
  ++windows_;
}

double TremorMeter::value_N() const {
  return windows_ > 0 ? std::sqrt(power_N2_ / static_cast<double>(windows_)) : 0.0;
}

}  // namespace osteon::procedure
