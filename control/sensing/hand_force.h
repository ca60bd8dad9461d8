#pragma once

#include "base/marker.h"
#include "control/ports.h"
#include "control/sensing/bias_estimator.h"
#include "control/sensing/tool_inertia.h"
#include "control/setup/servo_params.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// Computes the hand's wrench on the tool from the force sensor's readings. Removes the sensor's bias
/// (BiasEstimator), the tool's weight (HandWrench) and a share of the tool's inertial force (tool_inertia.h).
class HandForce {
 public:
  /// @throws std::invalid_argument as Validate(BiasParams). @param X_FT  tool on the flange
  HandForce(const ServoParams& params, const Pose& X_FT);

  /// Sets the load and pose of another tool. The estimated bias stays, because it belongs to the sensor.
  void SetTool(const ForceSensorParams& sensor, const Pose& X_FT) OSTEON_RT;

  /// Adds a reading to the estimate of the bias. Call with each message before the first motion, while the
  /// tool hangs at rest and nobody holds it.
  /// @param X_WT  measured tool pose
  void EstimateBias(const ForceReading& reading, const Pose& X_WT) OSTEON_RT;

  /// Restarts the estimate of the acceleration, at rest at this measured pose. Call when motion begins.
  void ResetMotion(const Pose& X_WT) OSTEON_RT;

  /// Computes the hand's wrench; call once per message.
  /// @param age_s      age of the reading; safety::kNoAge_s: there is none
  /// @param X_WT       measured tool pose
  /// @param elapsed_s  time since the previous message, > 0
  /// @returns the hand's wrench on T at To, in W; zero without a valid reading; not finite if the reading is
  /// not finite
  [[nodiscard]] Wrench ComputeHandWrench(const ForceReading& reading, double age_s, const Pose& X_WT,
                                         double elapsed_s) OSTEON_RT;

  /// Bias that is subtracted from every reading, in S.
  [[nodiscard]] const Wrench& bias() const OSTEON_RT { return bias_.bias(); }
  /// Whether the reading at rest is larger than the largest accepted bias: a hand probably rests on the
  /// handle.
  [[nodiscard]] bool bias_in_doubt() const OSTEON_RT { return bias_.in_doubt(); }

 private:
  ForceSensorParams sensor_;
  Pose X_TF_;
  BiasEstimator bias_;
  MeasuredMotion flange_motion_;
};

}  // namespace osteon::control
