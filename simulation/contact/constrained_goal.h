#pragma once

#include <array>
#include <span>

#include "kinematics/half_spaces.h"
#include "simulation/contact/cutting_constants.h"

namespace osteon::simulation {

inline constexpr std::size_t kMaxHolding = 4;  ///< three planes determine the point, a fourth the slack

/// The point nearest to the origin that a set of planes allows, and the planes on which it lies (the holding
/// planes).
struct ConstrainedGoal {
  Vector3 point_m{Vector3::Zero()};
  double slack_m{0.0};  ///< length s by which every plane yields
  int count{0};
  std::array<std::size_t, kMaxHolding> plane{};    ///< indices of the holding planes
  std::array<double, kMaxHolding> multiplier_m{};  ///< > 0; point_m is the sum of multiplier times normal n
};

/// Finds the point x closest to the origin in the intersection of any number of half-spaces n_i·x >=
/// offset_i. All half-spaces yield by the same slack s, which is large if they have no point in common, and
/// nearly zero otherwise:
///
///     min |x|^2 + s^2 / kHoldSlack     subject to     n_i·x + s >= offset_i
///
/// So there is always exactly one solution. The method is a dual active set: in each round the most violated
/// plane enters the set of holding planes. For each subset of the old holding planes (at most 15), the
/// nearest point on that subset and the new plane is computed; the subset whose point violates no old holding
/// plane is taken. The cost grows in each round, so no set recurs. No plane is violated by more than 10 nm at
/// the end. For up to eight planes, the point is that of ClosestInHalfSpaces except for the slack.
/// @param start  at most four planes that are likely to hold; if all of their multipliers are positive, the
/// search begins with them
[[nodiscard]] ConstrainedGoal FindConstrainedGoal(std::span<const HalfSpace> planes,
                                                  std::span<const std::size_t> start = {});

}  // namespace osteon::simulation
