#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "control/stability/biquad.h"
#include "kinematics/spatial.h"

// Filters that measure vibration.

namespace osteon::studies {

/// Filters a series of vectors to a band of frequencies: a fourth-order Butterworth high-pass at low_hz and a
/// low-pass at high_hz. The filters start at rest at the series' first value.
[[nodiscard]] inline std::vector<Vector3> BandPass(const std::vector<Vector3>& series, double low_hz,
                                                   double high_hz, double period_s) {
  // quality factors of the two second-order sections of a fourth-order Butterworth filter
  constexpr double kQa = 0.5411961001461970, kQb = 1.3065629648763766;
  using control::Biquad;
  Biquad high_a = Biquad::HighPass(low_hz, kQa, period_s), high_b = Biquad::HighPass(low_hz, kQb, period_s);
  Biquad low_a = Biquad::LowPass(high_hz, kQa, period_s), low_b = Biquad::LowPass(high_hz, kQb, period_s);
  std::vector<Vector3> band;
  band.reserve(series.size());
  for (const Vector3& v : series)
    band.push_back(low_b.Step(low_a.Step(high_b.Step(high_a.Step(v - series.front())))));
  return band;
}

/// Root mean square of the values [from, to); 0 if there are none.
[[nodiscard]] inline double Rms(const std::vector<Vector3>& series, std::size_t from, std::size_t to) {
  double sum = 0.0;
  for (std::size_t i = from; i < to; ++i) sum += series[i].squaredNorm();
  return to > from ? std::sqrt(sum / static_cast<double>(to - from)) : 0.0;
}

/// Root mean square of the values [from, from + count) within a band of frequencies. Unlike a filter's
/// result, it does not depend on earlier values: the regression line is subtracted, a Hann window is applied,
/// and a discrete Fourier transform follows (bins at multiples of 1 / duration).
[[nodiscard]] inline double RmsInBand(const std::vector<Vector3>& series, std::size_t from, std::size_t count,
                                      double low_hz, double high_hz, double period_s) {
  const double middle = 0.5 * static_cast<double>(count - 1), turn = 2.0 * std::numbers::pi;
  const auto n = static_cast<double>(count);
  const auto window = [&](std::size_t i) {
    return 0.5 - 0.5 * std::cos(turn * (static_cast<double>(i) + 0.5) / n);
  };
  // the regression line mean + slope × (i - middle), weighted by the window
  Vector3 mean = Vector3::Zero(), slope = Vector3::Zero();
  double weight = 0.0, weight_tt = 0.0, power = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) - middle, w = window(i);
    mean += w * series[from + i];
    slope += w * t * series[from + i];
    weight += w;
    weight_tt += w * t * t;
    power += w * w;
  }
  mean /= weight;
  slope /= weight_tt;
  // sum over the bins of the band; each counts twice, for the equal bin at the negative frequency
  double energy = 0.0;
  const double bin_hz = 1.0 / (n * period_s);
  for (int k = static_cast<int>(std::ceil(low_hz / bin_hz - 1e-9)); k * bin_hz <= high_hz * (1.0 + 1e-9);
       ++k) {
    Vector3 c = Vector3::Zero(), s = Vector3::Zero();
    for (std::size_t i = 0; i < count; ++i) {
      const Vector3 x = window(i) * (series[from + i] - mean - (static_cast<double>(i) - middle) * slope);
      c += std::cos(turn * k * static_cast<double>(i) / n) * x;
      s += std::sin(turn * k * static_cast<double>(i) / n) * x;
    }
    energy += 2.0 * (c.squaredNorm() + s.squaredNorm());
  }
  return std::sqrt(energy / (n * power));
}

}  // namespace osteon::studies
