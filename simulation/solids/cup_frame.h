#pragma once

#include "simulation/bone/bone.h"

namespace osteon::simulation {

/// X_GC: pose of a cup's frame C in G. Its +z is the cup's axis; its orientation is that of G, turned by the
/// shortest rotation that brings z onto the axis.
[[nodiscard]] inline Pose CupPose(const CutSite& cup) {
  Pose X_GC = Pose::Identity();
  X_GC.linear() = RotationFromZTo(Vector3(cup.axis).normalized());
  X_GC.translation() = Vector3(cup.center_m);
  return X_GC;
}

}  // namespace osteon::simulation
