#pragma once

#include "studies/stability/admittance_axis.h"

namespace osteon::studies {

/// Result of a run in which a hand, or a clamp, closes on a moving tool. The loop has the vibration index.
struct GripRun {
  double max_N{0.0};       ///< largest RMS force of the hand between 5 and 40 Hz over a window of 0.2 s
  double half_s_N{0.0};    ///< the same for windows from 0.5 s after the grip closed on
  double one_s_N{0.0};     ///< the same for windows from 1 s after the grip closed on
  double late_N{0.0};      ///< the same for windows in the last second
  double max_index{0.0};   ///< largest vibration index
  double late_index{0.0};  ///< largest index from 0.5 s after the grip closed on
  /// Factor on the law's damping: the largest; the mean from 1 s after the grip closed on.
  double max_damping{1.0}, mean_damping{1.0};
  bool valid{true};  ///< false: the law refused its input
};

/// Runs AdmittanceAxis for params.seconds (at least 2 s); the motion starts with the initial velocity of
/// `params`.
/// @throws std::invalid_argument if a parameter is out of range.
[[nodiscard]] GripRun RunGrip(const AdmittanceRunParams& params);

}  // namespace osteon::studies
