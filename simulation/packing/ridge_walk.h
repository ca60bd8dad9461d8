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
  double clearance_m{0.0};  ///< at its end, to first order
};

/// The step |δ| <= most to the greatest clearance t <= value + gradient·δ for every bound.
///
/// Straight away from the nearest obstacle until a second one is as near, along the ridge between these two
/// until a third is, then between the three: the direction is always the shortest vector in the hull of the
/// active gradients (that of steepest ascent), and those it is not made of are dropped. The walk ends where
/// the hull holds the origin, since no direction leads away from all of them, or at the length allowed.
/// @pre at least one bound.
[[nodiscard]] RidgeWalk WalkRidges(std::span<const ClearanceBound> bounds, double most_m);

}  // namespace osteon::simulation
