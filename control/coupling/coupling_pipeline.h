#pragma once

#include "base/marker.h"
#include "control/arm/arm_follower.h"
#include "control/coupling/virtual_coupling.h"
#include "control/setup/servo_params.h"
#include "control/stability/stabilisers.h"
#include "control/tick_record.h"
#include "safety/acting_limits.h"
#include "safety/depth_limit.h"
#include "safety/force_limit_reaction.h"
#include "safety/limits.h"
#include "safety/stored_energy_limit.h"
#include "simulation/contact/contact_model.h"

namespace osteon::control {

/// Where and when the coupling is evaluated.
struct CouplingInput {
  const simulation::ContactModel& model;  ///< the newest; must outlive the call
  Pose X_WT{Pose::Identity()};            ///< of the tool: commanded (admittance) or measured (impedance)
  Twist V_WT;                             ///< velocity of T at To, in W
  rt::Nanoseconds now{0};
  bool spindle_turns{false};
};

/// The coupling from the contact model to the wrench that a law renders, once for both laws:
///
///     contact model → virtual coupling → age governor, energy tank → stored energy, force, torque, arm
///                   → passivity damping → depth limit → power
///
/// Evaluate, then Render, then LimitPower, each at most once a tick. Whatever these return is within the
/// cell's limits of force and torque.
class CouplingPipeline {
 public:
  /// @param params  of the loop, whose gains may change between ticks (OnGainsChanged); must outlive this
  /// @throws std::invalid_argument naming the parameter, the value and what is accepted.
  explicit CouplingPipeline(const ServoParams& params);

  /// The tool takes up rendering.
  void Reset() OSTEON_RT;
  /// The loop's parameters have other gains from this tick on.
  void OnGainsChanged() OSTEON_RT;

  /// The coupling of this tick, limited to what its spring may store, the cell may render and the arm can
  /// hold.
  /// @param[in,out] acting  gains the limits that act
  const CouplingOutput& Evaluate(const CouplingInput& input, const ArmFollower& arm,
                                 safety::LimitSet& acting) OSTEON_RT;
  /// The limited wrench of the last Evaluate, before the stabilisers' damping.
  [[nodiscard]] const safety::LimitedWrench& limited() const OSTEON_RT { return limited_; }
  [[nodiscard]] const CouplingOutput& output() const OSTEON_RT { return output_; }

  /// The wrench to be rendered after the last Evaluate: with the passivity controller's damping and the depth
  /// limit's resistance, within the same limits.
  [[nodiscard]] safety::LimitedWrench Render(const ArmFollower& arm, safety::LimitSet& acting) OSTEON_RT;
  /// Scales a rendered wrench to `power_share` of it, 0 … 1, where that is less than 1.
  void LimitPower(double power_share, safety::LimitedWrench& rendered, safety::LimitSet& acting) OSTEON_RT;

  /// Limits that acted on a rendered wrench, by its shares and by the stabilisers.
  void AddActing(const safety::LimitedWrench& rendered, safety::LimitSet& acting) const OSTEON_RT;

  [[nodiscard]] const safety::WrenchLimiter& limiter() const OSTEON_RT { return limiter_; }
  [[nodiscard]] const Stabilisers& stabilisers() const OSTEON_RT { return stabilisers_; }
  [[nodiscard]] const safety::DepthLimit& depth_limit() const OSTEON_RT { return depth_limit_; }
  [[nodiscard]] const safety::ForceLimitReaction& force_limit_reaction() const OSTEON_RT {
    return force_limit_reaction_;
  }
  /// A plane was penetrated in the last Evaluate.
  [[nodiscard]] bool pressed() const OSTEON_RT { return pressed_; }

 private:
  const ServoParams& params_;
  safety::WrenchLimiter limiter_;
  safety::StoredEnergyLimit stored_energy_limit_;
  safety::DepthLimit depth_limit_;
  safety::ForceLimitReaction force_limit_reaction_;
  Stabilisers stabilisers_;
  CouplingState state_;

  // of the last Evaluate
  Pose X_WT_{Pose::Identity()};
  Twist V_WT_;
  CouplingOutput output_;
  safety::LimitedWrench limited_;
  bool pressed_{false};
};

}  // namespace osteon::control
