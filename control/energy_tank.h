#pragma once

#include "control/rt/marker.h"
#include "control/virtual_coupling.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// Tuning of EnergyTank. Every field has a usable default.
struct EnergyTankParams {
  bool acts{true};     ///< false: every hand-over is rendered at once, and the tank stays full
  double cap_J{1.0};   ///< full, and so at the beginning; should hold F_max^2 / 2K (200 N at 20 N/mm: 1 J)
  double ramp_s{0.1};  ///< fastest return of the coupling from nothing to full
};

/// @throws std::invalid_argument naming the field, the value found and what is accepted.
void Validate(const EnergyTankParams& params);

/// Pays for energy that no motion has put into the coupling: that of planes, material or gains that change in
/// time. With U_0 what the planes and gains of the tick before hold at this tick's pose, and U_1 those of
/// this tick:
///
///     U_1 > U_0:  the tank pays U_1 - U_0;  what it has not got is not rendered:
///                 share s = (U_0 + tank) / U_1
///     U_1 < U_0:  what the planes gave way by goes into the tank, up to the cap; so does what the
///                 coupling's damping took
///
/// so that over any time the coupling gives out no more than what was put in and the cap. The work of what a
/// hand-over adds to the planes' force (hand_over.h) is paid for, or fills, as it is done; of a hand-over
/// that the tank can not pay for, only hand_over_share() may be rendered. To either U belongs F·dx / 2 of the
/// step that led here: the integrator's own share of a force that jumps. U_0 comes from the planes that
/// pressed: exact for those, up to 1e-3 J at .25 m/s where a plane is touched within the very tick that a
/// frame comes in or a plane is on its way back. Otherwise a force that rises within a frame is the motion's
/// own and costs nothing; bone that recedes fills. The coupling's fade and the governor's share are gains; a
/// fall fills, their return costs. From s < 1 it comes back as the tank fills, by 1/ramp_s at most, and at
/// once where contact ends, which costs nothing.
///
/// It acts before any energy is out, but knows only of changes at a known time: what comes of a force that is
/// old, held or limited is the passivity controller's. Too small a tank can not pay for what frames
/// ordinarily differ by, and softens a wall that is stable. Source: control.md of the design; the idea is
/// Franken and others, IEEE Trans. Robotics 27, 2011 (from memory).
class EnergyTank {
 public:
  /// @throws std::invalid_argument as Validate.
  EnergyTank(const EnergyTankParams& params, double period_s);

  /// One tick. @param gain  that the coupling is rendered with beside its fade, 0 … 1
  /// @returns the share s of the coupling that may be rendered, 0 … 1
  double Step(const CouplingOutput& coupling, const Pose& X_WT, const Twist& V_WT, double gain) OSTEON_RT;

  /// As it was constructed.
  void Reset() OSTEON_RT;

  [[nodiscard]] double energy_J() const OSTEON_RT { return tank_J_; }
  [[nodiscard]] double paid_J() const OSTEON_RT { return paid_J_; }  ///< in the last tick
  [[nodiscard]] double share() const OSTEON_RT { return share_; }
  /// Of CouplingOutput::F_hand_over_T_W, what may be rendered, 0 … 1: usually all.
  [[nodiscard]] double hand_over_share() const OSTEON_RT { return hand_over_share_; }
  [[nodiscard]] bool acted() const OSTEON_RT { return share_ < 1.0; }

 private:
  EnergyTankParams params_;
  double period_s_, tank_J_, share_{1.0}, paid_J_{0.0};
  // the tick before
  bool begun_{false};
  Pose X_before_{Pose::Identity()};
  std::array<ActivePlane, CouplingOutput::kMostActive> active_{};
  int active_planes_{0};
  double potential_J_{0.0}, fade_{0.0}, gain_{0.0};
  double hand_over_share_{1.0};
  Wrench hand_over_T_W_;  // as rendered
};

}  // namespace osteon::control
