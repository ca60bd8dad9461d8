#pragma once

#include "base/marker.h"
#include "control/ports.h"
#include "control/sensing/bias_estimator.h"
#include "control/sensing/tool_inertia.h"
#include "control/setup/servo_params.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// Computes what the hand exerts on the tool from the force sensor's readings: without the sensor's zero bias
/// (BiasEstimator), the tool's weight (HandWrench) and a share of its inertia (tool_inertia.h).
class HandForce {
 public:
  /// @throws std::invalid_argument as Validate(BiasParams). @param X_FT  tool on the flange
  HandForce(const ServoParams& params, const Pose& X_FT);

  /// One message in which the tool hangs at rest before its first motion, and nobody holds it.
  /// @param X_WT  measured
  void EstimateBias(const ForceReading& reading, const Pose& X_WT) OSTEON_RT;

  /// Motion begins at this measured pose, at rest.
  void ResetMotion(const Pose& X_WT) OSTEON_RT;

  /// One message of a moving arm.
  /// @param age_s      of the reading; safety::kNoAge_s: there is none
  /// @param X_WT       measured
  /// @param elapsed_s  since the message before, > 0
  /// @returns the hand's wrench on T at To, in W; zero where no reading is to be trusted; not finite where
  /// the reading is not
  [[nodiscard]] Wrench Compute(const ForceReading& reading, double age_s, const Pose& X_WT,
                               double elapsed_s) OSTEON_RT;

  /// In S, taken from every reading.
  [[nodiscard]] const Wrench& bias() const OSTEON_RT { return bias_.bias(); }
  /// The reading at rest is larger than a bias may be: a hand rests on the handle.
  [[nodiscard]] bool bias_in_doubt() const OSTEON_RT { return bias_.in_doubt(); }

 private:
  ForceSensorParams sensor_;
  Pose X_TF_;
  BiasEstimator bias_;
  MeasuredMotion flange_motion_;
};

}  // namespace osteon::control
