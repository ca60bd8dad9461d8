#pragma once

#include "hil/operator/hand_script.h"

// Helpers for the tests of the operator's hand.

namespace osteon::hil {

/// Pose of a cup with a general orientation.
inline Pose TiltedCup() {
  Pose X_WC = Pose::Identity();
  X_WC.linear() = ExpRotation({0.7, -0.4, 0.3});
  X_WC.translation() = Vector3(0.5, -0.2, 0.4);
  return X_WC;
}

/// Centre of the tool's head in W. The scripts below use a head radius of 25 mm.
inline Vector3 HeadCenter(const Pose& X_WT) { return X_WT * Vector3(0.0, 0.0, -0.025); }

/// A script that holds the tool at one place in the tilted cup, with full grip.
inline HandScript Hold(double force_limit_N = 1e6, double height_m = 0.0) {
  const HandKey key{.height_m = height_m, .force_limit_N = force_limit_N, .tilt_rad = 0.0, .grip = 1.0};
  return HandScript(TiltedCup(), 0.025, 0.0, 2.0, key, {{"hold", 1.0, key}});
}

}  // namespace osteon::hil
