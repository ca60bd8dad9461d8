#pragma once

#include "studies/stability/admittance_axis.h"

namespace osteon::studies {

/// Result of a run in which a hand, or a clamp, closes on a moving tool, with the vibration index.
struct GripRun {
  double max_N{0.0};       ///< largest RMS force of the hand between 5 and 40 Hz over 0.2 s, at any time
  double half_s_N{0.0};    ///< the same from 0.5 s after the grip closed
  double one_s_N{0.0};     ///< the same from 1 s after the grip closed
  double late_N{0.0};      ///< the same in the last second
  double max_index{0.0};   ///< largest vibration index
  double late_index{0.0};  ///< the same from 0.5 s after the grip closed
  double max_damping{1.0}, mean_damping{1.0};  ///< factor on the law's damping: the largest, and the mean
                                               ///< from 1 s on
  bool valid{true};                            ///< false: the law refused its input
};

/// Runs AdmittanceAxis for params.seconds (at least 2 s), with the kick of `params`.
/// @throws std::invalid_argument on a parameter out of range.
[[nodiscard]] GripRun RunGrip(const AdmittanceRunParams& params);

}  // namespace osteon::studies
