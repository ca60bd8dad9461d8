#pragma once

#include <array>
#include <span>

#include "kinematics/half_spaces.h"
#include "simulation/contact/cutting_constants.h"

namespace osteon::simulation {

inline constexpr std::size_t kMaxHolding = 4;  ///< three planes fix a point, a fourth fixes the slack

/// The point nearest to the origin that planes allow, and the planes that hold it there.
struct ConstrainedGoal {
  Vector3 point_m{Vector3::Zero()};
  double slack_m{0.0};  ///< length by which all planes yield
  int count{0};
  std::array<std::size_t, kMaxHolding> plane{};    ///< the planes that hold, by index
  std::array<double, kMaxHolding> multiplier_m{};  ///< > 0; point = sum of multiplier n
};

/// Finds the closest point to the origin in the intersection of any number of half-spaces. All yield together
/// by a slack s, which is large where they have no point in common and nearly zero otherwise:
///
///     min |x|^2 + s^2 / kHoldSlack     subject to     n_i·x + s >= offset_i
///
/// so there is always one answer. Method: dual active set. In each round the most violated plane enters.
/// Among the subsets of the holding planes, each with the new plane (at most 15), the one whose point
/// violates no holding plane is taken. The cost grows in each round, so no set recurs. A plane is kept to
/// within 10 nm. For up to eight planes the point is that of ClosestInHalfSpaces, but for the slack.
/// @param start  planes that are likely to hold, at most four: where they hold by themselves, the search
///   begins with them
[[nodiscard]] ConstrainedGoal FindConstrainedGoal(std::span<const HalfSpace> planes,
                                                  std::span<const std::size_t> start = {});

}  // namespace osteon::simulation
