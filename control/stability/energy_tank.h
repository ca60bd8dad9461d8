#pragma once

#include "base/marker.h"
#include "control/coupling/virtual_coupling.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// Tuning of EnergyTank. Every field has a usable default.
struct EnergyTankParams {
  bool acts{true};     ///< false: the tank stays full and limits nothing
  double cap_J{1.0};   ///< capacity and initial energy; should hold F_max^2 / 2K (200 N at 20 N/mm: 1 J)
  double ramp_s{0.1};  ///< shortest time in which the scale returns from 0 to 1
};

/// @throws std::invalid_argument naming the field, the value found and what is accepted.
void Validate(const EnergyTankParams& params);

/// Store of energy. Changes of planes, material or gains can add energy to the coupling's spring that no
/// motion has put in; the tank pays for this energy. Let U_0 be the energy that the planes and gains of the
/// previous tick would store at this tick's pose, and U_1 the energy that this tick's planes and gains store:
///
///     U_1 > U_0:  the tank pays U_1 - U_0;  if it holds less, the coupling is scaled:
///                 scale s = (U_0 + tank) / U_1
///     U_1 < U_0:  the difference goes into the tank, up to the cap; so does the energy that the coupling's
///                 damping has dissipated
///
/// Over any time, the coupling therefore gives out at most the energy that was put in, plus the cap.
///
/// - Motion: a force that rises while the planes stay those of one frame is due to the motion and costs
/// nothing. Planes that recede fill the tank.
/// - Gains: the coupling's fade and the governor's scale are gains. A falling gain fills the tank, and a
/// rising gain draws from it.
/// - Hand-over: a hand-over adds a force to that of the planes (hand_over.h). In each tick the tank pays for
/// the work of this force, or receives it. If it cannot pay for the whole hand-over, only hand_over_scale()
/// of it may be
///   rendered.
/// - Scale: after s < 1, the scale rises as the tank fills, by at most 1/ramp_s. It returns to 1 at once when
///   contact ends, which costs nothing.
/// - Accuracy: each U includes F·dx / 2 of the last step, the energy that the integration over a step adds if
/// the force jumps. U_0 is exact for the planes that were touched in the previous tick. Its error is at most
/// 1e-3 J at 0.25 m/s if a plane is first
///   touched in the tick in which a frame arrives or a held-back plane is being released.
///
/// The tank acts before energy reaches the tool, but covers only changes of planes and gains between ticks,
/// whose time is known. The passivity controller covers the effects of an old, held or limited force. A tank
/// that is too small cannot pay for the usual differences between frames, and softens a stable wall. Source:
/// control.md of the design; the idea is Franken and others, IEEE Trans. Robotics 27, 2011 (from memory).
class EnergyTank {
 public:
  /// @throws std::invalid_argument as Validate.
  EnergyTank(const EnergyTankParams& params, double period_s);

  /// Computes one tick. @param gain  gain on the coupling in addition to its fade, 0 … 1
  /// @returns the scale s with which the coupling may be rendered, 0 … 1
  double Step(const CouplingOutput& coupling, const Pose& X_WT, const Twist& V_WT, double gain) OSTEON_RT;

  /// Returns to the state after construction.
  void Reset() OSTEON_RT;

  [[nodiscard]] double energy_J() const OSTEON_RT { return tank_J_; }
  [[nodiscard]] double paid_J() const OSTEON_RT { return paid_J_; }  ///< energy paid in the last tick
  [[nodiscard]] double scale() const OSTEON_RT { return scale_; }
  /// Scale with which CouplingOutput::F_hand_over_T_W may be rendered, 0 … 1: usually 1.
  [[nodiscard]] double hand_over_scale() const OSTEON_RT { return hand_over_scale_; }
  [[nodiscard]] bool acted() const OSTEON_RT { return scale_ < 1.0; }

 private:
  EnergyTankParams params_;
  double period_s_, tank_J_, scale_{1.0}, paid_J_{0.0};
  // the members below are values of the previous tick
  bool begun_{false};  // there was a previous tick
  Pose X_before_{Pose::Identity()};
  std::array<ActivePlane, CouplingOutput::kMaxActive> active_{};
  int active_planes_{0};
  double potential_J_{0.0}, fade_{0.0}, gain_{0.0};
  double hand_over_scale_{1.0};
  Wrench hand_over_T_W_;  // rendered wrench of the hand-over
};

}  // namespace osteon::control
