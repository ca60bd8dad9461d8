#pragma once

#include <optional>

#include "procedure/plan/surgical_plan.h"
#include "simulation/bone/bone.h"
#include "simulation/engine/cutting_engine.h"

namespace osteon::procedure {

/// The opening that a session made, compared with the plan. The figures come from the final carved state: its
/// balls give the depth, its mass points the rest.
struct OpeningResult {
  /// Distance across the axis between the centroid of the hard tissue that was removed and that of the plan
  /// [m]; nothing: none was removed.
  std::optional<double> shift_m;
  /// How much deeper than planned the floor is [m]; negative: not deep enough. Nothing: no ball was cut.
  std::optional<double> depth_error_m;
  /// Share of the target's roof, seen along the axis within the planned opening less 0.2 mm at its rim, over
  /// which no hard tissue is left within the plan; nothing: the planned opening does not meet the target.
  std::optional<double> unroofed;
};

/// Measures shift, depth and roof of the opening.
/// @param plan  for an opening
/// @param uncut  the bone before the session
/// @param state  state of the bone after the session, with its mass points in the same order
[[nodiscard]] OpeningResult AssessOpening(const SurgicalPlan& plan, const simulation::Bone& uncut,
                                          const simulation::CarvedState& state);

}  // namespace osteon::procedure
