#pragma once

#include "base/marker.h"
#include "control/coupling/virtual_coupling.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// Tuning of EnergyTank. Every field has a usable default.
struct EnergyTankParams {
  bool acts{true};     ///< false: every hand-over is rendered at once, and the tank stays full
  double cap_J{1.0};   ///< capacity and initial energy; should hold F_max^2 / 2K (200 N at 20 N/mm: 1 J)
  double ramp_s{0.1};  ///< shortest time in which the coupling returns from nothing to full
};

/// @throws std::invalid_argument naming the field, the value found and what is accepted.
void Validate(const EnergyTankParams& params);

/// Store that pays for the coupling's energy that no motion has put in, when planes, material or gains change
/// in time. Let U_0 be the energy that the planes and gains of the tick before store at this tick's pose, and
/// U_1 the same for this tick's planes and gains:
///
///     U_1 > U_0:  the tank pays U_1 - U_0;  if it holds less, the rest is not rendered:
///                 share s = (U_0 + tank) / U_1
///     U_1 < U_0:  the energy that the planes lost goes into the tank, up to the cap; so does the energy
///                 that the coupling's damping took
///
/// Over any time the coupling therefore gives out at most what was put in, plus the cap. The work of the
/// force that a hand-over adds to the planes' force (hand_over.h) is paid, or fills the tank, as it is done;
/// if the tank cannot pay for all of a hand-over, only hand_over_share() of it may be rendered. Each U
/// includes F·dx / 2 of the step that led here: the integrator's own share of a force that jumps. U_0 comes
/// from the planes that pressed. It is exact for those, and off by at most 1e-3 J at 0.25 m/s if a plane is
/// touched in the very tick in which a frame arrives or a plane is on its way back. Otherwise a force that
/// rises within a frame is due to the motion and costs nothing; bone that recedes fills the tank. The
/// coupling's fade and the governor's share are gains: their fall fills the tank, their return costs. The
/// share returns from s < 1 as the tank fills, by at most 1/ramp_s, and at once when contact ends, which
/// costs nothing.
///
/// The tank acts before any energy is out, but only covers changes at a known time: the effects of a force
/// that is old, held or limited are the passivity controller's. A tank that is too small cannot pay for the
/// usual differences between frames, and softens a wall that is stable. Source: control.md of the design; the
/// idea is Franken and others, IEEE Trans. Robotics 27, 2011 (from memory).
class EnergyTank {
 public:
  /// @throws std::invalid_argument as Validate.
  EnergyTank(const EnergyTankParams& params, double period_s);

  /// One tick. @param gain  other gain on the coupling beside its fade, 0 … 1
  /// @returns the share s of the coupling that may be rendered, 0 … 1
  double Step(const CouplingOutput& coupling, const Pose& X_WT, const Twist& V_WT, double gain) OSTEON_RT;

  /// Returns to the state after construction.
  void Reset() OSTEON_RT;

  [[nodiscard]] double energy_J() const OSTEON_RT { return tank_J_; }
  [[nodiscard]] double paid_J() const OSTEON_RT { return paid_J_; }  ///< in the last tick
  [[nodiscard]] double share() const OSTEON_RT { return share_; }
  /// Share of CouplingOutput::F_hand_over_T_W that may be rendered, 0 … 1: usually 1.
  [[nodiscard]] double hand_over_share() const OSTEON_RT { return hand_over_share_; }
  [[nodiscard]] bool acted() const OSTEON_RT { return share_ < 1.0; }

 private:
  EnergyTankParams params_;
  double period_s_, tank_J_, share_{1.0}, paid_J_{0.0};
  // the tick before
  bool begun_{false};
  Pose X_before_{Pose::Identity()};
  std::array<ActivePlane, CouplingOutput::kMaxActive> active_{};
  int active_planes_{0};
  double potential_J_{0.0}, fade_{0.0}, gain_{0.0};
  double hand_over_share_{1.0};
  Wrench hand_over_T_W_;  // as rendered
};

}  // namespace osteon::control
