#pragma once

#include "hil/stability/admittance_axis.h"

namespace osteon::hil {

/// A hand, or a clamp, that closes on a tool which moves, and what the vibration index makes of it.
struct GripRun {
  double most_N{0.0};      ///< force of the hand between 5 and 40 Hz, effective over .2 s: the greatest
  double half_s_N{0.0};    ///< from .5 s after the grip closed on,
  double one_s_N{0.0};     ///< from 1 s on,
  double late_N{0.0};      ///< and in the last second
  double most_index{0.0};  ///< of the vibration index
  double late_index{0.0};  ///< the same from .5 s on
  double most_damping{1.0}, mean_damping{1.0};  ///< times the law's: the greatest, and the mean from 1 s on
  bool valid{true};                             ///< false: the law refused what it was given
};

/// Runs AdmittanceAxis for params.seconds (at least 2 s), with the kick that params say.
/// @throws std::invalid_argument on a parameter out of range.
[[nodiscard]] GripRun RunGrip(const AdmittanceRunParams& params);

}  // namespace osteon::hil
