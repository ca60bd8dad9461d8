#pragma once

#include <vector>

#include "kinematics/spatial.h"

namespace osteon::procedure {

/// Measures the RMS value of a hand's force between 6 and 14 Hz.
///
/// Windows of 2 s, overlapping by half, are weighted by Hann's function and transformed at multiples of 0.5
/// Hz. Frequencies within 1 Hz of a multiple of the spindle's speed are left out, because there the cut
/// itself causes vibration. A force of 1 N at 10 Hz gives 0.707 N.
class TremorMeter {
 public:
  explicit TremorMeter(double period_s);

  void Add(const Vector3& force_N, double spindle_rad_per_s);
  /// RMS force over all windows so far; 0 before the first whole window.
  [[nodiscard]] double value_N() const;

  static constexpr double kLow_hz = 6.0, kHigh_hz = 14.0, kWindow_s = 2.0, kNotch_hz = 1.0;

 private:
  void AddWindow();

  double period_s_;
  std::size_t window_;                     ///< number of samples in a window
  std::vector<Vector3> samples_;           ///< samples that a present or later window needs
  std::vector<double> spindle_rad_per_s_;  ///< spindle speed at each of samples_
  double power_N2_{0.0};                   ///< sum of the windows' mean squares in the band
  std::size_t windows_{0};
};

}  // namespace osteon::procedure
