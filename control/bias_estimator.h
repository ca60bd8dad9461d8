#pragma once

#include "control/hand_wrench.h"
#include "control/rt/marker.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// Tuning of BiasEstimator. Every field has a usable default.
struct BiasParams {
  bool acts{true};         ///< false: nothing is taken out
  double rest_s{0.5};      ///< what lies this long at rest is believed; the mean's memory as well
  double spread_N{1.5};    ///< a reading farther from the mean is no rest: somebody touches the tool
  double spread_Nm{0.15};  ///< the same of the torque
  double most_N{10.0};     ///< a larger bias is none: it is left in, and felt
  double most_Nm{2.0};     ///< the same of the torque
  double still_m{1e-4};    ///< the flange may stir this far,
  double still_rad{1e-3};  ///< and turn by this much
};

/// @throws std::invalid_argument naming the field, the value found and what is accepted.
void Validate(const BiasParams& params);

/// What a force sensor reads beyond its load, estimated while the tool hangs at rest and nobody holds it.
///
///     bias = mean over the rest of (F_S - weight of the tool at this posture - ForceSensorParams::bias_S)
///
/// The loop asks for it while it waits for the arm (Phase::kWaiting) and keeps it while it renders. **Nobody
/// may hold the handle then**: a steady push below most_N looks like a bias, and would be taken out for good.
/// What moves, trembles or pushes harder is noticed, and the last rest that was believed counts.
///
/// What it can do: take out the zero's offset, and what the payload's mass is off by at that posture. What it
/// can not: follow a drift while the tool is in use, or a payload error as the tool turns. Those two look
/// like a hand that pushes lightly, and a slow high-pass that took them out would eat a constant push. The
/// dead zone has to cover them (AdmittanceParams): drift times the length of the run, and 2 sin(turn / 2) g
/// times the mass error; .1 N/s for 30 s and .2 kg turned by 30 deg are 3 N + 1 N.
class BiasEstimator {
 public:
  /// @throws std::invalid_argument as Validate. @param period_s  of Rest, > 0
  BiasEstimator(const BiasParams& params, const ForceSensorParams& sensor, double period_s);

  /// One tick in which the loop does nothing. @param F_S  as the sensor reads it  @param X_WF  flange in
  /// world
  void Rest(const Wrench& F_S, const Pose& X_WF) OSTEON_RT;

  /// To be taken from a reading, in S at S's origin; zero until a rest was believed.
  [[nodiscard]] const Wrench& bias() const OSTEON_RT { return bias_; }

 private:
  void Begin(const Wrench& F_S, const Pose& X_WF) OSTEON_RT;

  BiasParams params_;
  ForceSensorParams sensor_;
  double period_s_;
  Wrench bias_;  ///< believed
  Wrench mean_;  ///< of this rest
  double rested_s_{0.0};
  bool resting_{false};
  Pose X_WF_{Pose::Identity()};  ///< where it began
};

}  // namespace osteon::control
