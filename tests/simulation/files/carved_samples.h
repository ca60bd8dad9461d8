#pragma once

#include "simulation/bone/bone.h"
#include "simulation/engine/cutting_engine.h"
#include "simulation/tools/tool.h"

// A small bone for tests of carved states: a row of five balls. A larger cutting ball comes down on it, and
// balls are split, one a frame.

namespace osteon::simulation::test {

/// The uncut row along x from G's origin, 3 mm apart, with a mass point in each ball.
inline Bone CarvedBone() {
  Bone bone;
  bone.name = "test";
  for (int i = 0; i < 5; ++i) {
    bone.balls.push_back({.center_m = Vector3(3e-3 * i, 0, 0), .radius_m = 2e-3});
    bone.points.push_back({.p_m = Vector3(3e-3 * i, 0, 0), .volume_m3 = 30e-9});
  }
  bone.materials = {{.name = "test",
                     .density_kg_per_m3 = 500.0,
                     .specific_cutting_energy_J_per_m3 = 1e6,
                     .cutting_force_ratio = 0.8}};
  return bone;
}

/// Removal at once, with one ball split in a frame.
inline CuttingParams CarvedParams() {
  CuttingParams params;
  params.law = RemovalLaw::kImmediate;
  params.split = {.on = true, .blocks_per_frame = 1};
  return params;
}

/// One cutting ball of radius 4 mm about T's origin.
inline Tool CarvedTool() {
  Tool tool;
  tool.name = "ball";
  tool.balls = {{.center_m = Vector3(0, 0, 0), .radius_m = 4e-3}};
  return tool;
}

/// A frame with the tool over the row at height z_m, its spindle on.
inline FrameInput CarvedFrame(double z_m) {
  Pose X = Pose::Identity();
  X.translation() = Vector3(4e-3, 0, z_m);
  return {.X_WT = X, .spindle_rad_per_s = 30.0};
}

}  // namespace osteon::simulation::test
