#pragma once

#include <vector>

#include "simulation/bone.h"
#include "simulation/cutting_engine.h"
#include "simulation/tool.h"

// What the scenarios are made of: blocks whose faces are known exactly, tools of one ball, poses. G is W.

namespace osteon::hil {

/// A box along the axes, of equal balls on a cubic lattice and, where asked for, mass points.
struct BlockParams {
  Vector3 low_m{Vector3::Zero()}, high_m{Vector3::Zero()};
  /// Of the balls; each side is at least twice that. Their spacing is 2/3 of it or a little less: a tool of
  /// radius R rests within spacing² / (4 (R + r)) of a face.
  double ball_radius_m{0.75e-3};
  double point_spacing_m{0.0};                    ///< 0: no mass points
  double specific_cutting_energy_J_per_m3{60e6};  ///< cancellous bone, assumed (design: .06 J/mm³)
};
/// @throws std::invalid_argument where a side is shorter than two radii.
[[nodiscard]] simulation::Bone MakeBlock(const BlockParams& params);

/// One ball that cuts, its apex at T's origin.
[[nodiscard]] simulation::Tool MakeBallTool(double radius_m);

/// Feed straight down, apex at p.
[[nodiscard]] Pose Downwards(const Vector3& p_m);

[[nodiscard]] inline simulation::FrameInput FrameAt(const Pose& X_WT, double spindle_rad_per_s = 0.0,
                                                    double dt_s = 1e-3) {
  return {.X_WT = X_WT, .spindle_rad_per_s = spindle_rad_per_s, .dt_s = dt_s};
}

/// Balls that a snapshot has left, children of split ones included.
[[nodiscard]] std::vector<simulation::Ball> BallsLeft(const simulation::CarvedState& state);

inline constexpr double kScenarioSpindle_rad_per_s = 26.17993877991494;  ///< 250 rpm

}  // namespace osteon::hil
