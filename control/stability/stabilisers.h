#pragma once

#include "control/stability/age_governor.h"
#include "control/stability/energy_tank.h"
#include "control/stability/passivity.h"
#include "control/tick_record.h"
#include "safety/limits.h"

namespace osteon::control {

/// Parameters of the three stabilisers of the coupling. Every field has a usable default.
struct StabiliserParams {
  AgeGovernorParams age_governor;
  PassivityParams passivity;
  EnergyTankParams energy_tank;
};

/// Parameters with all three switched off, to show what fails without them.
[[nodiscard]] inline StabiliserParams NoStabilisers() {
  StabiliserParams none;
  none.age_governor.acts = none.passivity.acts = none.energy_tank.acts = false;
  return none;
}

/// @throws std::invalid_argument naming the field, the value found and what is accepted.
void Validate(const StabiliserParams& params);

/// Properties of the law that the stabilisers depend on.
struct StabilisedLaw {
  AxisDamping damping;     ///< >= 0
  double pose_age_s{0.0};  ///< age of the pose at which the planes are evaluated
  PortWork work{PortWork::kTrapezoid};
  double max_damping_Ns_per_m{1e3};  ///< largest damping that a tick of the law tolerates; > 0
};

/// The three stabilisers in the order in which they act:
///
///     coupling → age governor: scale, damping → energy tank: scale → limits → passivity: damping → law
///
/// The governor comes before the tank because its scale is a gain of the coupling, and the tank must pay when
/// a gain rises. Governor and tank act before energy reaches the tool. The passivity controller observes the
/// coupling after the limits of force, torque and stored energy, and learns the power limit's scale through
/// ScaleRendered. It does not observe the depth limit's resistance, which is not a force of the planes. The
/// passivity controller is the last resort: with governor and tank active it usually has nothing to correct.
class Stabilisers {
 public:
  /// @throws std::invalid_argument as Validate.
  Stabilisers(const StabiliserParams& params, const StabilisedLaw& law, double period_s);

  /// To be called when the loop starts rendering.
  void Reset() OSTEON_RT;

  /// Sets the law's properties after a change of gains: its damping, and the largest damping that a tick
  /// tolerates.
  void SetLaw(const StabilisedLaw& law) OSTEON_RT;

  /// Scales the coupling, before the limits. @param X_WT, V_WT  pose and velocity at which the coupling was
  /// evaluated
  /// @returns the coupling's wrench times the scales of governor and tank; unchanged if both are 1.
  [[nodiscard]] Wrench ScaleCoupling(const CouplingOutput& coupling, const Pose& X_WT,
                                     const Twist& V_WT) OSTEON_RT;

  /// Adds the passivity controller's damping, after the limits. Coupling, pose and velocity must be those
  /// given to ScaleCoupling.
  /// @param limited  ScaleCoupling's result after the limits
  /// @returns the wrench to render: limited.F, plus the damping if there is energy to take back, within the
  ///   limiter's force and torque
  [[nodiscard]] Wrench AddPassivityDamping(const CouplingOutput& coupling, const Pose& X_WT,
                                           const Twist& V_WT, const safety::LimitedWrench& limited,
                                           const safety::WrenchLimiter& limiter) OSTEON_RT;

  /// Reports that a later limit passed only this share of AddPassivityDamping's wrench, 0 … 1.
  void ScaleRendered(double share) OSTEON_RT { passivity_.ScaleRendered(share); }

  /// Writes the stabilisers' results into the record.
  void FillRecord(TickRecord& record) const OSTEON_RT;

  /// Factor on the law's damping; >= 1.
  [[nodiscard]] double damping_factor() const OSTEON_RT { return governor_.damping_factor(); }
  [[nodiscard]] const AgeGovernor& governor() const OSTEON_RT { return governor_; }
  [[nodiscard]] const PassivityController& passivity() const OSTEON_RT { return passivity_; }
  [[nodiscard]] const EnergyTank& tank() const OSTEON_RT { return tank_; }

 private:
  [[nodiscard]] Wrench RemoveUnpaidHandOver(const CouplingOutput& coupling,
                                            const Wrench& F_T_W) const OSTEON_RT;

  StabilisedLaw law_;
  AgeGovernor governor_;
  EnergyTank tank_;
  PassivityController passivity_;
};

}  // namespace osteon::control
