#pragma once

#include <span>

#include "kinematics/spatial.h"

namespace osteon::simulation {

/// One upper bound of the clearance around a point, to first order: value + gradient·δ.
struct ClearanceBound {
  double value_m{0.0};
  Vector3 gradient{Vector3::Zero()};  ///< unit, away from the obstacle
};

struct RidgeWalk {
  Vector3 step_m{Vector3::Zero()};
  double clearance_m{0.0};  ///< at the step's end, to first order
};

/// Computes the step |δ| <= max_m to the largest clearance t <= value + gradient·δ for every bound.
///
/// The walk leads straight away from the nearest obstacle until a second one is as near, then along the ridge
/// between these two until a third one is, then between the three. Its direction is always that of steepest
/// ascent: the shortest vector in the hull of the active gradients. Gradients that do not contribute to it
/// are dropped. The walk ends where the hull holds the origin, since no direction leads away from all of
/// them, or at the allowed length.
/// @pre at least one bound.
[[nodiscard]] RidgeWalk WalkRidges(std::span<const ClearanceBound> bounds, double max_m);

}  // namespace osteon::simulation
