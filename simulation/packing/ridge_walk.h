#pragma once

#include <span>

#include "kinematics/spatial.h"

namespace osteon::simulation {

/// One upper bound of the clearance at a displacement δ from a point, to first order: value + gradient·δ. It
/// stands for one obstacle.
struct ClearanceBound {
  double value_m{0.0};
  Vector3 gradient{Vector3::Zero()};  ///< unit vector away from the obstacle
};

struct RidgeWalk {
  Vector3 step_m{Vector3::Zero()};
  double clearance_m{0.0};  ///< clearance at the step's end, to first order
};

/// Computes the step δ with |δ| <= max_m that leads to the largest clearance. This is the largest t with t <=
/// value + gradient·δ for every bound.
///
/// The walk leads straight away from the nearest obstacle until a second obstacle is as near. Then it follows
/// the ridge between the two until a third one is as near, then the line between the three. Its direction is
/// always that of steepest ascent: the shortest vector in the convex hull of the active gradients. Gradients
/// that do not contribute to this vector are dropped. The walk ends if the hull contains the origin, because
/// no direction then leads away from all active obstacles, or at the length max_m.
/// @pre at least one bound.
[[nodiscard]] RidgeWalk WalkRidges(std::span<const ClearanceBound> bounds, double max_m);

}  // namespace osteon::simulation
