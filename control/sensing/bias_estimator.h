#pragma once

#include "base/marker.h"
#include "control/laws/admittance_law.h"
#include "control/sensing/hand_wrench.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// Tuning of BiasEstimator. Every field has a usable default.
struct BiasParams {
  bool acts{true};  ///< false: no bias is removed
  /// duration of rest after which a bias is accepted; also the time constant of the mean
  double rest_s{0.5};
  double spread_N{1.5};     ///< a reading farther from the mean ends the rest: someone touches the tool
  double spread_Nm{0.15};   ///< as spread_N, for the torque
  double max_bias_N{10.0};  ///< largest accepted bias
  double max_bias_Nm{2.0};  ///< as max_bias_N, for the torque
  /// If a hand's push was taken for a bias and the hand then lets go, the free tool creeps. This is the
  /// largest accepted speed of that motion, > 0. With the law's drag it bounds the accepted bias
  /// (CreepBound).
  double max_creep_m_per_s{0.05};
  double max_creep_rad_per_s{0.25};  ///< as max_creep_m_per_s, for the rotation
  double rest_motion_m{1e-4};        ///< largest motion of the flange during a rest
  double rest_rotation_rad{1e-3};    ///< largest rotation of the flange during a rest
};

/// @throws std::invalid_argument naming the field, the value found and what is accepted.
void Validate(const BiasParams& params);

/// Returns the parameters with max_bias_N and max_bias_Nm lowered if necessary. The bound is the force at
/// which a free tool creeps with max_creep_m_per_s. So if a hand's push was taken for a bias, the tool creeps
/// no faster once the hand lets go:
///
///     |bias| <= dead zone + smallest drag × max_creep
///
/// @param law  admittance law of the virtual tool
[[nodiscard]] BiasParams CreepBound(const BiasParams& params, const AdmittanceParams& law);

/// Estimates the bias of a force sensor while the tool hangs at rest and nobody holds it.
///
///     bias = mean over the rest of (F_S - weight of the tool at this posture - ForceSensorParams::bias_S)
///
/// The loop estimates the bias until it renders for the first time. Then it keeps the bias, because a hand
/// may be at the handle after a pause or in a recovery. **Nobody may hold the handle before the first
/// motion.**
///
/// Readings alone do not distinguish a steady push from a bias. A bias is therefore accepted only up to a
/// bound (CreepBound). Beyond the bound, in_doubt() is true, and the loop does not begin to move until the
/// hand lets go or the sensor's zero is calibrated. Unsteady readings, for example of a hand that trembles or
/// pushes unevenly, do not count as rest.
///
/// Subtracting the bias removes the sensor's zero offset and the error of the payload's mass at that posture.
/// It does not remove the sensor's drift during use, nor the effect of the payload's error when the tool
/// turns. Both look like a light push of a hand. A slow high-pass filter would remove them, but also a
/// constant push. Therefore the dead zone (AdmittanceParams) must cover them: drift × duration of the run,
/// plus 2 sin(turn / 2) g × the error of the mass. For example, 0.1 N/s for 30 s and 0.2 kg turned by 30 deg
/// give 3 N + 1 N.
class BiasEstimator {
 public:
  /// @param period_s  period of AddReading, > 0  @throws std::invalid_argument as Validate.
  BiasEstimator(const BiasParams& params, const ForceSensorParams& sensor, double period_s);

  /// Adds the reading of a tick in which the loop waits.
  /// @param F_S  the sensor's reading  @param X_WF  flange in world
  void AddReading(const Wrench& F_S, const Pose& X_WF) OSTEON_RT;

  /// Bias to subtract from a reading, in S at S's origin; zero until a rest has been accepted.
  [[nodiscard]] const Wrench& bias() const OSTEON_RT { return bias_; }
  /// Whether the bias found in the last rest exceeded the bound, and no bias has been accepted since.
  [[nodiscard]] bool in_doubt() const OSTEON_RT { return in_doubt_; }

 private:
  void StartRest(const Wrench& F_S, const Pose& X_WF) OSTEON_RT;

  BiasParams params_;
  ForceSensorParams sensor_;
  double period_s_;
  Wrench bias_;  ///< bias by the last accepted rest
  Wrench mean_;  ///< mean over the present rest
  double rested_s_{0.0};
  bool resting_{false}, in_doubt_{false};
  Pose X_WF_{Pose::Identity()};  ///< flange pose at the beginning of the rest
};

}  // namespace osteon::control
