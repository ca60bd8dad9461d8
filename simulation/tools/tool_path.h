#pragma once

#include <vector>

#include "kinematics/spatial.h"
#include "simulation/tools/tool.h"

namespace osteon::simulation {

/// Centres of the tool's balls and T's origin at one pose, in G. The last entry is the origin.
using ToolPoints = std::vector<Vector3>;
[[nodiscard]] ToolPoints PlaceTool(const Tool& tool, const Pose& X_GT);

/// Points at fraction s on the chords between two placements.
[[nodiscard]] ToolPoints InterpolatePoints(const ToolPoints& a, const ToolPoints& b, double s);

/// Largest distance of a chord from its arc [m].
inline constexpr double kChordError_m = 10e-6;
/// Largest number of chords of a turn, whatever its error.
inline constexpr int kMaxChords = 128;

/// Number of chords of a turn, so that each stays within kChordError_m of its arc:
///
///     n = ceil(theta sqrt(L / (8 eps)))        from the sagitta L (theta/n)^2 / 8
///
/// 1 for a hand's turn in a millisecond (up to 23 rad/s at L = 150 mm); 11 for 0.24 rad after a stall of 0.1
/// s.
/// @param turn_rad  theta >= 0;  @param lever_m  L, the largest distance of a ball's centre from T's origin
[[nodiscard]] int ChordCount(double turn_rad, double lever_m);

/// Largest distance of a ball's centre from T's origin.
[[nodiscard]] double ToolLever(const Tool& tool);

/// Number of parts in which a frame from P to T is computed: one, unless its turn needs more chords.
[[nodiscard]] int SubframeCount(double lever_m, const Pose& X_WP, const Pose& X_WT);

/// Pose k of n on the way from A to B: T's origin on the straight line, the turn about one axis.
[[nodiscard]] Pose PoseBetween(const Pose& X_WA, const Pose& X_WB, int k, int n);

}  // namespace osteon::simulation
