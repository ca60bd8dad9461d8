#pragma once

#include "control/admittance_law.h"
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
  double most_N{10.0};     ///< a larger one is no bias, whatever else is accepted
  double most_Nm{2.0};     ///< the same of the torque
  /// If the estimate was a hand's push after all, a free tool creeps once the hand is gone: at most so fast.
  /// With the law's drag it bounds what is believed: CreepBound. > 0
  double max_creep_m_per_s{0.05};
  double max_creep_rad_per_s{0.25};  ///< the same of the turn
  double still_m{1e-4};              ///< the flange may stir this far,
  double still_rad{1e-3};            ///< and turn by this much
};

/// @throws std::invalid_argument naming the field, the value found and what is accepted.
void Validate(const BiasParams& params);

/// The same with most_N and most_Nm lowered to what an admittance law bears: a bias that was really a hand's
/// push makes the free tool creep no faster than max_creep_m_per_s once the hand lets go.
///
///     |bias| <= dead zone + least drag × max_creep
///
/// @param law  of the virtual tool
[[nodiscard]] BiasParams CreepBound(const BiasParams& params, const AdmittanceParams& law);

/// What a force sensor reads beyond its load, estimated while the tool hangs at rest and nobody holds it.
///
///     bias = mean over the rest of (F_S - weight of the tool at this posture - ForceSensorParams::bias_S)
///
/// The loop asks for it until it renders for the first time, and keeps it from then on: after a pause or in a
/// recovery a hand may be at the handle. **Nobody may hold the handle before the first motion.** A steady
/// push can't be told from a bias by its readings. So a rest is believed up to a bound only (CreepBound), and
/// a steady reading beyond it is in_doubt(): the loop does not begin to move until the hand lets go, or the
/// sensor's zero is calibrated. What moves, trembles or pushes unevenly is no rest.
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
  /// The last rest read more than can be believed, and no rest has been believed since.
  [[nodiscard]] bool in_doubt() const OSTEON_RT { return in_doubt_; }

 private:
  void Begin(const Wrench& F_S, const Pose& X_WF) OSTEON_RT;

  BiasParams params_;
  ForceSensorParams sensor_;
  double period_s_;
  Wrench bias_;  ///< believed
  Wrench mean_;  ///< of this rest
  double rested_s_{0.0};
  bool resting_{false}, in_doubt_{false};
  Pose X_WF_{Pose::Identity()};  ///< where it began
};

}  // namespace osteon::control
