#pragma once

#include "studies/stability/admittance_axis.h"

namespace osteon::studies {

/// Result of a run in which a hand, or a clamp, closes on a moving tool, with the vibration index.
struct GripRun {
  double max_N{0.0};       ///< force of the hand between 5 and 40 Hz, effective over 0.2 s: the largest
  double half_s_N{0.0};    ///< the same from 0.5 s after the grip closed on
  double one_s_N{0.0};     ///< from 1 s on
  double late_N{0.0};      ///< in the last second
  double max_index{0.0};   ///< of the vibration index
  double late_index{0.0};  ///< the same from 0.5 s on
  double max_damping{1.0}, mean_damping{1.0};  ///< factor on the law's damping: the largest, and the mean
                                               ///< from 1 s on
  bool valid{true};                            ///< false: the law refused its input
};

/// Runs AdmittanceAxis for params.seconds (at least 2 s), with the kick of params.
/// @throws std::invalid_argument on a parameter out of range.
[[nodiscard]] GripRun RunGrip(const AdmittanceRunParams& params);

}  // namespace osteon::studies
