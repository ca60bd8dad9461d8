#pragma once

#include <array>
#include <cstdint>

#include "base/marker.h"

namespace osteon::control {

/// One line of a multisine: amplitude cos(2 pi harmonic t / period + phase).
struct MultisineLine {
  int harmonic{0};  ///< odd
  double amplitude_m{0.0};
  double phase_rad{0.0};
};

struct MultisineState {
  double x_m{0.0}, v_m_per_s{0.0}, a_m_per_s2{0.0};
};

/// Odd random-phase multisine: a periodic motion whose power lies on kLines odd harmonics alone.
///
///     x(t) = sum_i a_i cos(2 pi h_i t / P + phi_i)     period P = 4 s, frequencies h_i / P = 0.75 … 59.25 Hz
///     a_i ~ 1 / f up to 20 Hz (constant speed), ~ 1 / f^2 above (constant acceleration)
///
/// The harmonics h_i are evenly spaced in log(f). Every fourth odd harmonic (7, 15, 23, …) and all even
/// harmonics have no power: the response at these odd harmonics shows odd nonlinearities of the plant, the
/// response at the even harmonics shows even ones. The phases phi_i are random: of kDraws sets of phases, the
/// one with the lowest crest factor of the speed is used. Same seed, same bits. Source: Schoukens, Vaes,
/// Pintelon, IEEE Control Systems Magazine 36(3), 2016.
class Multisine {
 public:
  static constexpr int kLines = 27;  ///< harmonics with power
  static constexpr double kPeriod_s = 4.0;
  static constexpr int kMinHarmonic = 3, kMaxHarmonic = 237;
  static constexpr int kDraws = 100;  ///< random sets of phases that are tried
  /// up to this frequency, all lines have the same speed amplitude
  static constexpr double kFlatSpeed_hz = 20.0;

  /// For set-up; takes some 10 ms. @param seed  of the random phases
  /// @param peak_speed_m_per_s  largest speed; > 0
  /// @throws std::invalid_argument if the peak speed is not > 0
  Multisine(std::uint64_t seed, double peak_speed_m_per_s);

  /// The motion at a time [s]; it repeats with the period. Does not allocate.
  [[nodiscard]] MultisineState At(double time_s) const OSTEON_RT;

  /// Scales all amplitudes. @param factor  > 0
  void Scale(double factor);

  [[nodiscard]] const std::array<MultisineLine, kLines>& lines() const { return lines_; }
  /// Largest values over a period, sampled each millisecond.
  [[nodiscard]] const MultisineState& peak() const { return peak_; }
  [[nodiscard]] double rms_speed_m_per_s() const;

  /// Frequency of a harmonic [Hz].
  [[nodiscard]] static constexpr double Frequency(int harmonic) { return harmonic / kPeriod_s; }
  /// Whether a harmonic is odd and left empty: 7, 15, 23, …
  [[nodiscard]] static constexpr bool IsEmptyOdd(int harmonic) { return harmonic % 8 == 7; }
  /// The harmonics with power, rising.
  [[nodiscard]] static std::array<int, kLines> Harmonics();

 private:
  std::array<MultisineLine, kLines> lines_{};
  MultisineState peak_;
};

}  // namespace osteon::control
