#pragma once

#include "base/marker.h"
#include "control/laws/admittance_law.h"
#include "control/sensing/hand_wrench.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// Tuning of BiasEstimator. Every field has a usable default.
struct BiasParams {
  bool acts{true};          ///< false: no bias is removed
  double rest_s{0.5};       ///< a rest of this duration is accepted; also the time constant of the mean
  double spread_N{1.5};     ///< a reading farther from the mean is not at rest: somebody touches the tool
  double spread_Nm{0.15};   ///< the same for the torque
  double max_bias_N{10.0};  ///< largest bias that is accepted
  double max_bias_Nm{2.0};  ///< the same for the torque
  /// Bounds the creep of a free tool in case the estimate was a hand's push and the hand lets go. Together
  /// with the law's drag this bounds the accepted bias: CreepBound. > 0
  double max_creep_m_per_s{0.05};
  double max_creep_rad_per_s{0.25};  ///< the same for the rotation
  double rest_motion_m{1e-4};        ///< the flange may move this far during a rest,
  double rest_rotation_rad{1e-3};    ///< and rotate this far
};

/// @throws std::invalid_argument naming the field, the value found and what is accepted.
void Validate(const BiasParams& params);

/// The same parameters with max_bias_N and max_bias_Nm lowered to what an admittance law tolerates: if the
/// bias was a hand's push, the free tool creeps at most at max_creep_m_per_s once the hand lets go.
///
///     |bias| <= dead zone + least drag × max_creep
///
/// @param law  of the virtual tool
[[nodiscard]] BiasParams CreepBound(const BiasParams& params, const AdmittanceParams& law);

/// Offset of a force sensor, estimated while the tool hangs at rest and nobody holds it.
///
///     bias = mean over the rest of (F_S - weight of the tool at this posture - ForceSensorParams::bias_S)
///
/// The loop estimates until it renders for the first time and keeps the bias from then on: after a pause or
/// in a recovery a hand may be at the handle. **Nobody may hold the handle before the first motion.**
/// Readings alone cannot tell a steady push from a bias. A rest is therefore accepted up to a bound only
/// (CreepBound). A steady reading beyond the bound is in_doubt(): the loop does not begin to move until the
/// hand lets go or the sensor's zero is calibrated. A reading that moves, trembles or is pushed unevenly does
/// not count as rest.
///
/// It removes the offset of the zero, and the error of the payload's mass at that posture. It cannot follow a
/// drift during use, or a payload error as the tool turns. Both look like a hand that pushes lightly, and a
/// slow high-pass that removed them would also remove a constant push. The dead zone has to cover them
/// (AdmittanceParams): drift times the length of the run, and 2 sin(turn / 2) g times the mass error; 0.1 N/s
/// for 30 s and 0.2 kg turned by 30 deg are 3 N + 1 N.
class BiasEstimator {
 public:
  /// @throws std::invalid_argument as Validate. @param period_s  of AddReading, > 0
  BiasEstimator(const BiasParams& params, const ForceSensorParams& sensor, double period_s);

  /// One tick in which the loop does nothing. @param F_S  as the sensor reads it  @param X_WF  flange in
  /// world
  void AddReading(const Wrench& F_S, const Pose& X_WF) OSTEON_RT;

  /// The bias to subtract from a reading, in S at S's origin; zero until a rest was accepted.
  [[nodiscard]] const Wrench& bias() const OSTEON_RT { return bias_; }
  /// Whether the last rest exceeded the accepted bound, and none has been accepted since.
  [[nodiscard]] bool in_doubt() const OSTEON_RT { return in_doubt_; }

 private:
  void StartRest(const Wrench& F_S, const Pose& X_WF) OSTEON_RT;

  BiasParams params_;
  ForceSensorParams sensor_;
  double period_s_;
  Wrench bias_;  ///< accepted
  Wrench mean_;  ///< of this rest
  double rested_s_{0.0};
  bool resting_{false}, in_doubt_{false};
  Pose X_WF_{Pose::Identity()};  ///< at the beginning of the rest
};

}  // namespace osteon::control
