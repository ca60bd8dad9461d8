#pragma once

#include <optional>

#include "procedure/plan/surgical_plan.h"
#include "simulation/bone/bone.h"
#include "simulation/engine/cutting_engine.h"

namespace osteon::procedure {

/// The opening at the end of a session, compared with the plan. The depth is computed from the balls of the
/// final carved state, all other figures from its mass points.
struct OpeningResult {
  /// Distance across the axis between the centroid of the removed hard tissue and the centroid of the hard
  /// tissue in the planned opening [m]; nothing: no hard tissue was removed.
  std::optional<double> shift_m;
  /// Depth of the floor minus the planned depth [m]; negative: not deep enough; nothing: no ball was cut.
  std::optional<double> depth_error_m;
  /// Share of the target's roof (hard tissue above the target, seen along the axis) that has been removed.
  /// Counted in the planned opening without 0.2 mm at its rim. Nothing: the planned opening has no such roof.
  std::optional<double> unroofed;
};

/// Measures shift, depth and roof of the opening.
/// @param plan  a plan for an opening
/// @param uncut  the bone before the session
/// @param state  state of the bone after the session, with its mass points in the same order
[[nodiscard]] OpeningResult AssessOpening(const SurgicalPlan& plan, const simulation::Bone& uncut,
                                          const simulation::CarvedState& state);

}  // namespace osteon::procedure
