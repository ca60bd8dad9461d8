#pragma once

#include "control/age_governor.h"
#include "control/energy_tank.h"
#include "control/passivity.h"
#include "control/tick_record.h"
#include "safety/limits.h"

namespace osteon::control {

/// What keeps the coupling stable beside the vibration index. Every field has a usable default.
struct StabiliserParams {
  AgeGovernorParams age_governor;
  PassivityParams passivity;
  EnergyTankParams energy_tank;
};

/// None of them acts: for what fails without.
[[nodiscard]] inline StabiliserParams NoStabilisers() {
  StabiliserParams none;
  none.age_governor.acts = none.passivity.acts = none.energy_tank.acts = false;
  return none;
}

/// @throws std::invalid_argument naming the field, the value found and what is accepted.
void Validate(const StabiliserParams& params);

/// Of the law that they stand beside.
struct StabilisedLaw {
  AxisDamping damping;     ///< >= 0
  double pose_age_s{0.0};  ///< of the pose that the planes are evaluated at
  PortWork work{PortWork::kTrapezoid};
  double most_damping_Ns_per_m{1e3};  ///< that a tick of it bears; > 0
};

/// The three in the order in which they act:
///
///     coupling → age governor: share, damping → energy tank: share → limits → passivity: damping → law
///
/// The governor comes first, as it is a gain of the coupling; the tank pays for every gain's return. Both act
/// before energy is out. The passivity controller sees the coupling after the limits of force, torque and
/// stored energy, and is told by ScaleRendered what the limit of power takes from it. The depth limit's
/// resistance is no force of the planes and is not in it. It is the last resort: where the others have done
/// their part it has nothing to do.
class Stabilisers {
 public:
  /// @throws std::invalid_argument as Validate.
  Stabilisers(const StabiliserParams& params, const StabilisedLaw& law, double period_s);

  /// A tool takes up rendering.
  void Reset() OSTEON_RT;

  /// The law has other gains from this tick on: of `law` the damping, and what of it a tick bears.
  void Follow(const StabilisedLaw& law) OSTEON_RT;

  /// Before the limits. @param X_WT, V_WT  that the coupling was evaluated at
  /// @returns the coupling's wrench with both shares; it itself where they are 1.
  [[nodiscard]] Wrench Shape(const CouplingOutput& coupling, const Pose& X_WT, const Twist& V_WT) OSTEON_RT;

  /// After them, with the same coupling, pose and velocity. @param limited  of what Shape returned
  /// @returns what is to be rendered: limited.F, and where there is energy to take back its damping, within
  /// the
  ///   limiter's force and torque
  [[nodiscard]] Wrench Calm(const CouplingOutput& coupling, const Pose& X_WT, const Twist& V_WT,
                            const safety::LimitedWrench& limited,
                            const safety::WrenchLimiter& limiter) OSTEON_RT;

  /// Tells that a limit after Calm let only this share of its wrench through, 0 … 1.
  void ScaleRendered(double share) OSTEON_RT { passivity_.ScaleRendered(share); }

  /// Into its fields of the record.
  void Put(TickRecord& record) const OSTEON_RT;

  /// By which the law's damping is to be multiplied; >= 1.
  [[nodiscard]] double damping_factor() const OSTEON_RT { return governor_.damping_factor(); }
  [[nodiscard]] const AgeGovernor& governor() const OSTEON_RT { return governor_; }
  [[nodiscard]] const PassivityController& passivity() const OSTEON_RT { return passivity_; }
  [[nodiscard]] const EnergyTank& tank() const OSTEON_RT { return tank_; }

 private:
  [[nodiscard]] Wrench Paid(const CouplingOutput& coupling, const Wrench& F_T_W) const OSTEON_RT;

  StabilisedLaw law_;
  AgeGovernor governor_;
  EnergyTank tank_;
  PassivityController passivity_;
};

}  // namespace osteon::control
