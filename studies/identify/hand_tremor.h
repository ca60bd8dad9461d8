#pragma once

#include <span>

#include "control/stability/vibration_index.h"
#include "kinematics/spatial.h"

namespace osteon::studies {

/// The tremor of a hand that holds the handle of a standing arm at working push.
struct HandTremor {
  double p999_N{0.0};       ///< 99.9th percentile of the RMS force between 5 and 40 Hz over 0.2 s
  double tremor_N{0.0};     ///< tremor that a cell's vibration index should tolerate; tested with the index
  double drag_factor{1.0};  ///< mean factor on the drag that the index with tremor_N gives this hand
  double push_N{0.0};       ///< mean force, without the tool's weight if that was removed
  double seconds{0.0};
};

/// Measures a tremor. From p999_N on, tremor_N grows by factors of 1.2 until the shipped VibrationIndex over
/// the same recording gives a mean drag factor of at most 1.02.
/// @param F_T  the hand's wrench at the tool's apex, one per period, 5 s or more; shorter: zeros result
/// @param params  the cell's index; its tremor_N is not used
[[nodiscard]] HandTremor MeasureTremor(std::span<const Wrench> F_T, const control::VibrationParams& params,
                                       double period_s);

}  // namespace osteon::studies
