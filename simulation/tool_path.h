#pragma once

#include <vector>

#include "kinematics/spatial.h"
#include "simulation/tool.h"

namespace osteon::simulation {

/// Tool ball centres and T's origin at one pose, in G. The last entry is the origin.
using ToolPoints = std::vector<Vector3>;
[[nodiscard]] ToolPoints PlaceTool(const Tool& tool, const Pose& X_GT);

/// Points on the chords between two placements.
[[nodiscard]] ToolPoints Between(const ToolPoints& a, const ToolPoints& b, double s);

/// Placements of a tool along its way, and chords between them: every ball's path is a polygon.
struct ToolPath {
  std::vector<ToolPoints> at;  ///< two or more
  std::vector<double> s;       ///< of each placement: ascending from 0 to 1

  /// @param share  0 … 1
  [[nodiscard]] ToolPoints Place(double share) const;
  /// The placements from the start to `share`.
  [[nodiscard]] std::vector<ToolPoints> UpTo(double share) const;
};

/// A chord stays within this of the arc that it stands for [m].
inline constexpr double kChordError_m = 10e-6;
inline constexpr int kMostChords = 128;

/// How many chords a turn takes so that each stays within kChordError_m of its arc:
///
///     n = ceil(theta sqrt(L / (8 eps)))        from the sagitta L (theta/n)^2 / 8
///
/// 1 for what a hand does in a millisecond (23 rad/s at L = 150 mm); 11 for .24 rad after a stall of .1 s.
/// @param turn_rad  theta >= 0;  @param lever_m  L, the largest distance of a ball's centre from T's origin
[[nodiscard]] int ChordCount(double turn_rad, double lever_m);

/// The way between two poses, T's origin on the straight line and the turn about one axis.
[[nodiscard]] ToolPath PathBetween(const Tool& tool, const Pose& X_GA, const Pose& X_GB);

/// What is left of a path after `share`, moved by a displacement that grows in proportion.
[[nodiscard]] ToolPath RestOf(const ToolPath& path, double share, const Vector3& delta);

}  // namespace osteon::simulation
