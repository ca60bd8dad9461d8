#pragma once

#include <vector>

#include "kinematics/spatial.h"
#include "simulation/tools/tool.h"

namespace osteon::simulation {

/// Centres of the tool's balls and T's origin at one pose, in G. The last entry is the origin.
using ToolPoints = std::vector<Vector3>;
[[nodiscard]] ToolPoints PlaceTool(const Tool& tool, const Pose& X_GT);

/// Points at the fraction s of the straight lines from a to b.
[[nodiscard]] ToolPoints InterpolatePoints(const ToolPoints& a, const ToolPoints& b, double s);

/// Largest distance of a chord from its arc [m].
inline constexpr double kChordError_m = 10e-6;
/// Largest number of chords for a turn, even if their error is then larger.
inline constexpr int kMaxChords = 128;

/// Number n of chords for a turn by theta, so that each chord stays within eps = kChordError_m of its arc:
///
///     n = ceil(theta sqrt(L / (8 eps)))        from the sagitta L (theta/n)^2 / 8
///
/// The result is 1 for a turn by hand in a millisecond (up to 23 rad/s at L = 150 mm), and 11 for 0.24 rad
/// after a stall of 0.1 s.
/// @param turn_rad  theta >= 0;  @param lever_m  L, the largest distance of a ball's centre from T's origin
[[nodiscard]] int ChordCount(double turn_rad, double lever_m);

/// Largest distance of a ball's centre from T's origin.
[[nodiscard]] double ToolLever(const Tool& tool);

/// Number of parts into which a frame from the pose P to T is divided: one, unless its turn needs more
/// chords.
[[nodiscard]] int SubframeCount(double lever_m, const Pose& X_WP, const Pose& X_WT);

/// Pose k of n on the way from A to B: the origin moves on a straight line, and the rotation is about one
/// axis.
[[nodiscard]] Pose PoseBetween(const Pose& X_WA, const Pose& X_WB, int k, int n);

}  // namespace osteon::simulation
