#pragma once

#include <array>

#include "kinematics/spatial.h"

namespace osteon {

inline constexpr int kMaxHalfSpaces = 8;

/// The half-space { x : n·x >= offset }, n unit.
struct HalfSpace {
  Vector3 n{Vector3::UnitZ()};
  double offset{0.0};
};

struct HalfSpaceProjection {
  Vector3 point{Vector3::Zero()};  ///< the closest point to the origin in the intersection
  /// point = sum of multiplier[i] n_i. Each multiplier is >= 0, and at most four are nonzero.
  std::array<double, kMaxHalfSpaces> multiplier{};
  /// distance of the point outside the worst half-space; 0 if the point is in all of them
  double violation{0.0};
};

/// Finds the point closest to the origin in the intersection of up to eight half-spaces. This is the
/// constrained position of a god-object's proxy.
///
///     min |x|^2   subject to   n_i·x >= offset_i
///
/// Exact and bounded: a dual active-set method finds the planes that the point lies on, and the point is then
/// solved from these planes alone. If rounding prevents this (planes almost parallel), every set of one, two
/// or three planes is tried (92 for eight planes), and the nearest point that satisfies all planes wins.
/// Equal inputs give equal outputs. If the intersection is empty (opposite walls closer than the tool) all
/// planes yield by the least common amount,
///
///     min |x|^2 + 1e6 s^2   subject to   n_i·x + s >= offset_i
///
/// so that the point stays between the walls, and `violation` is that amount s > 0 (162 sets at most).
/// @pre 0 <= count <= kMaxHalfSpaces; all values finite.
[[nodiscard]] HalfSpaceProjection ClosestInHalfSpaces(const std::array<HalfSpace, kMaxHalfSpaces>& planes,
                                                      int count) noexcept;

}  // namespace osteon
