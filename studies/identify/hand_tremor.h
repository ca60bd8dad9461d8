#pragma once

#include <span>

#include "control/stability/vibration_index.h"
#include "kinematics/spatial.h"

namespace osteon::studies {

/// The tremor of a hand that holds the handle of an arm at rest and pushes as in work.
struct HandTremor {
  double p999_N{0.0};       ///< 99.9th percentile of the RMS force between 5 and 40 Hz over 0.2 s
  double tremor_N{0.0};     ///< value for the cell's vibration index: the tremor that the index tolerates
  double drag_factor{1.0};  ///< mean factor on the drag that the index gives this recording, with tremor_N
  double push_N{0.0};       ///< mean force of the hand; the tool's weight is included unless it was removed
  double seconds{0.0};
};

/// Measures a tremor. tremor_N starts at p999_N, and grows by factors of 1.2 until the shipped
/// VibrationIndex, over the same recording, gives a mean drag factor of at most 1.02.
/// @param F_T  the hand's wrench at the tool's apex, one per period, at least 5 s; if shorter, the result is
/// zero
/// @param params  the cell's vibration index; its tremor_N is not used
[[nodiscard]] HandTremor MeasureTremor(std::span<const Wrench> F_T, const control::VibrationParams& params,
                                       double period_s);

}  // namespace osteon::studies
