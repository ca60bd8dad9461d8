#pragma once

#include <array>
#include <span>

#include "kinematics/half_spaces.h"
#include "simulation/cutting_constants.h"

namespace osteon::simulation {

inline constexpr std::size_t kMostHolding = 4;  ///< three planes fix a point, a fourth its slack

/// The point in which planes hold the origin back.
struct HoldPoint {
  Vector3 point_m{Vector3::Zero()};
  double slack_m{0.0};  ///< by which all planes yield
  int count{0};
  std::array<std::size_t, kMostHolding> plane{};    ///< the planes that hold, by index
  std::array<double, kMostHolding> multiplier_m{};  ///< > 0; point = sum of multiplier n
};

/// Closest point to the origin in the intersection of any number of half-spaces, which yield together by a
/// slack s, much where they have no point in common and next to nothing otherwise:
///
///     min |x|^2 + s^2 / kHoldSlack     subject to     n_i·x + s >= offset_i
///
/// so there is always one answer. Dual active set: the most violated plane enters, and of the sets of it and
/// those that hold (15 at most) the one whose point keeps them all is taken; the cost grows with each, so
/// none comes back. A plane is kept to within 10 nm. For up to eight planes the same point as
/// ClosestInHalfSpaces, but for the slack.
/// @param start  planes that are likely to hold, four at most: where they do by themselves, the search begins
///   there
[[nodiscard]] HoldPoint FindHoldPoint(std::span<const HalfSpace> planes,
                                      std::span<const std::size_t> start = {});

}  // namespace osteon::simulation
