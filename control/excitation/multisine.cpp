#include "control/excitation/multisine.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/number_text.h"

namespace osteon::control {
namespace {

constexpr int kSamples = 4000;  // samples of a period, 1 ms apart
constexpr double kTwoPi = 2.0 * std::numbers::pi;

// Random number, uniform in [0, 1). The output of std::mt19937_64 is the same on every platform; that of a
// std:: distribution is not.
double Uniform(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1.0p-53; }

using Phases = std::array<double, Multisine::kLines>;

// Peak speed over a period. The lines' phases are given as indices into the table `cosines`. If the peak
// reaches `limit`, the search ends early.
double PeakSpeed(const std::array<MultisineLine, Multisine::kLines>& lines,
                 const std::vector<double>& cosines, double limit) {
  double peak = 0.0;
  for (int k = 0; k < kSamples && peak < limit; ++k) {
    double speed = 0.0;
    for (const MultisineLine& line : lines) {
      // -a w sin(h t + phi) by a table: sin(p) = cos(p - quarter); phases are multiples of the table's step
      const auto at = static_cast<std::size_t>(
          (line.harmonic * k + static_cast<int>(line.phase_rad) + kSamples - kSamples / 4) % kSamples);
      speed -= line.amplitude_m * Multisine::Frequency(line.harmonic) * kTwoPi * cosines[at];
    }
    peak = std::max(peak, std::abs(speed));
  }
  return peak;
}

}  // namespace

std::array<int, Multisine::kLines> Multisine::Harmonics() {
  std::array<int, kLines> harmonics{};
  int last = kMinHarmonic - 2;
  // Frequencies evenly spaced in log(f). Each is rounded to the nearest odd harmonic that may have power.
  for (std::size_t i = 0; i < kLines; ++i) {
    const double share = static_cast<double>(i) / (kLines - 1);
    const double target = kMinHarmonic * std::pow(static_cast<double>(kMaxHarmonic) / kMinHarmonic, share);
    int harmonic = 2 * static_cast<int>(std::lround(0.5 * (target - 1.0))) + 1;  // the nearest odd one
    harmonic = std::max(harmonic, last + 2);
    if (IsEmptyOdd(harmonic)) harmonic += 2;
    harmonics[i] = last = harmonic;
  }
  return harmonics;
}

Multisine::Multisine(std::uint64_t seed, double peak_speed_m_per_s) {
  if (!(peak_speed_m_per_s > 0.0 && std::isfinite(peak_speed_m_per_s)))
    throw std::invalid_argument("multisine: peak speed: found " + base::NumberText(peak_speed_m_per_s) +
                                " m/s, accepted > 0");
  const std::array<int, kLines> harmonics = Harmonics();
  for (std::size_t i = 0; i < kLines; ++i) {
    const double hz = Frequency(harmonics[i]);
    // relative to the speed of the lowest line
    const double speed = hz <= kFlatSpeed_hz ? 1.0 : kFlatSpeed_hz / hz;
    lines_[i] = {.harmonic = harmonics[i], .amplitude_m = speed / (kTwoPi * hz)};
  }
  std::vector<double> cosines(kSamples);
  for (int k = 0; k < kSamples; ++k) cosines[static_cast<std::size_t>(k)] = std::cos(kTwoPi * k / kSamples);

  // During the search, phase_rad holds an index into the table, not an angle.
  std::mt19937_64 random(seed);
  double lowest_peak = std::numeric_limits<double>::infinity();
  Phases best{};
  for (int draw = 0; draw < kDraws; ++draw) {
    for (MultisineLine& line : lines_) line.phase_rad = std::floor(kSamples * Uniform(random));
    const double peak = PeakSpeed(lines_, cosines, lowest_peak);
    if (!(peak < lowest_peak)) continue;
    lowest_peak = peak;
    for (std::size_t i = 0; i < kLines; ++i) best[i] = lines_[i].phase_rad;
  }
  for (std::size_t i = 0; i < kLines; ++i) lines_[i].phase_rad = kTwoPi * best[i] / kSamples;
  Scale(1.0);  // computes the peaks
  Scale(peak_speed_m_per_s / peak_.v_m_per_s);
}

void Multisine::Scale(double factor) {
  for (MultisineLine& line : lines_) line.amplitude_m *= factor;
  peak_ = {};
  for (int k = 0; k < kSamples; ++k) {
    const MultisineState at = At(kPeriod_s * k / kSamples);
    peak_.x_m = std::max(peak_.x_m, std::abs(at.x_m));
    peak_.v_m_per_s = std::max(peak_.v_m_per_s, std::abs(at.v_m_per_s));
    peak_.a_m_per_s2 = std::max(peak_.a_m_per_s2, std::abs(at.a_m_per_s2));
  }
}

MultisineState Multisine::At(double time_s) const OSTEON_RT {
  MultisineState state;
  for (const MultisineLine& line : lines_) {
    const double w = kTwoPi * Frequency(line.harmonic), angle = w * time_s + line.phase_rad;
    const double c = line.amplitude_m * std::cos(angle), s = line.amplitude_m * std::sin(angle);
    state.x_m += c;
    state.v_m_per_s -= w * s;
    state.a_m_per_s2 -= w * w * c;
  }
  return state;
}

double Multisine::rms_speed_m_per_s() const {
  double squares = 0.0;
  for (const MultisineLine& line : lines_) {
    const double speed = line.amplitude_m * kTwoPi * Frequency(line.harmonic);
    squares += 0.5 * speed * speed;
  }
  return std::sqrt(squares);
}

}  // namespace osteon::control
