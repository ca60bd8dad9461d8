#pragma once

#include <vector>

#include "simulation/bone/bone.h"
#include "simulation/engine/cutting_engine.h"
#include "simulation/tools/tool.h"

// Parts of the scenarios: blocks whose faces are known exactly, tools of one ball, poses. The bone's frame G
// is the world's frame W.

namespace osteon::studies {

/// An axis-aligned box of equal balls on a cubic lattice, with mass points if requested.
struct BlockParams {
  Vector3 low_m{Vector3::Zero()}, high_m{Vector3::Zero()};
  /// Radius of the balls; each side of the block is at least twice the radius. The spacing of the balls is
  /// 2/3 of the radius or a little less. A tool of radius R then rests within spacing² / (4 (R + r)) of a
  /// face, with the balls' radius r.
  double ball_radius_m{0.75e-3};
  double point_spacing_m{0.0};                    ///< 0: no mass points
  double specific_cutting_energy_J_per_m3{60e6};  ///< cancellous bone, assumed (design: 0.06 J/mm³)
};
/// @throws std::invalid_argument if a side is shorter than two radii.
[[nodiscard]] simulation::Bone MakeBlock(const BlockParams& params);

/// A tool of one cutting ball. The apex is T's origin; the ball's centre lies one radius behind it, at -z.
[[nodiscard]] simulation::Tool MakeBallTool(double radius_m);

/// A pose whose feed points straight down, apex at p.
[[nodiscard]] Pose Downwards(const Vector3& p_m);

/// The simulation's input for one frame of length dt with the tool at this pose.
[[nodiscard]] inline simulation::FrameInput FrameAt(const Pose& X_WT, double spindle_rad_per_s = 0.0,
                                                    double dt_s = 1e-3) {
  return {.X_WT = X_WT, .spindle_rad_per_s = spindle_rad_per_s, .dt_s = dt_s};
}

/// Remaining balls of a carved state, including the children of split balls.
[[nodiscard]] std::vector<simulation::Ball> BallsLeft(const simulation::CarvedState& state);

inline constexpr double kScenarioSpindle_rad_per_s = 26.17993877991494;  ///< 250 rpm

}  // namespace osteon::studies
