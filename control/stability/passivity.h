#pragma once

#include "base/marker.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// Tuning of PassivityController. Every field has a usable default.
struct PassivityParams {
  bool acts{true};  ///< false: the energy is observed and recorded, but no damping is added
  /// Dissipated energy that is remembered and may come back; >= 0. Errors of the trapezoids, of frames that
  /// replace each other and of the coupling's damping, which is a tick old, are smaller.
  double allowance_J{0.02};
  double min_speed_m_per_s{0.005};  ///< below it the quotient is noise: the energy is kept for later; > 0
  double max_damping_Ns_per_m{1000.0};
  double lever_m{0.1};  ///< lever at which rotation counts as translation
};

/// @throws std::invalid_argument naming the field, the value found and what is accepted.
void Validate(const PassivityParams& params);

/// When the force of a tick does its work.
enum class PortWork {
  /// The mean of both ends of a step counts. For a tool that the loop integrates itself (semi-implicit): a
  /// spring then gives back over any closed path exactly what it took. F_k dx would count K dx^2 / 2 of every
  /// tick as generated, in and out, at a wall that is stable.
  kTrapezoid,
  /// The force is held until the next tick. For a real arm (impedance law), where this is true: K dx^2 / 2
  /// per tick is really generated.
  kHeld,
};

/// Exchange of the coupling with the tool in a tick.
struct PortTick {
  Wrench F_T_W{};           ///< of the planes, as rendered: faded, limited; zero without contact
  double potential_J{0.0};  ///< stored energy that the planes give back if the tool leaves
  double paid_J{0.0};       ///< paid into the planes in this tick by an energy tank: may come out
  bool contact{false};
  Pose X_WT{Pose::Identity()};  ///< where the force acts
  Twist V_WT{};                 ///< velocity there, which the damping acts against
};

/// Passivity observer and controller on the coupling's port, over six axes:
///
///     E += F·dx                 energy that the planes have given to the tool; dx of this tick
///     E -= what an energy tank has paid into the planes
///     E  = max(E, -(U + allowance))
///     E > 0:  alpha = E / (T |V|_L^2),  F -= alpha (v, L^2 w),  |V|_L^2 = v^2 + L^2 w^2
///
/// E > 0 means that more energy came out than was ever put in: the virtual side has generated energy. The
/// damping takes it back, in one tick if speed and bounds allow, otherwise over several. Energy dissipated
/// long ago must not hide energy generated now (cutting dissipates for minutes): E remembers only what the
/// planes store, U, and the allowance. When contact ends E starts again, with 2 mJ for the touch itself.
///
/// The damping has two bounds: `max_Ns_per_m` of the constructor, so that it cannot reverse the motion
/// within a tick (m/T of a virtual tool), and the params' bound. The caller limits the sum.
///
/// Limits of the method: it sees energy only after it has come out, so a first impact is unchanged; it covers
/// nothing at the arm or the hand; and it ignores a force that pushes without generating energy (planes that
/// are wrong but at rest).
/// Source: control.md of the design; the idea is Hannaford and Ryu, IEEE Trans. Robotics Automation 18, 2002
/// (from memory).
class PassivityController {
 public:
  /// @throws std::invalid_argument as Validate. @param max_Ns_per_m  > 0
  PassivityController(const PassivityParams& params, PortWork work, double period_s, double max_Ns_per_m);

  /// One tick. @returns the damping to add to F; zero while inactive.
  [[nodiscard]] Wrench Step(const PortTick& port) OSTEON_RT;

  /// Returns to the state after construction.
  void Reset() OSTEON_RT;
  /// Replaces the constructor's bound; > 0. The params' own bound stays in force.
  void SetMaxDamping(double max_Ns_per_m) OSTEON_RT;
  /// Tells that a later limit passed only this share of the last step's force and damping, 0 … 1: the energy
  /// counts what was rendered.
  void ScaleRendered(double share) OSTEON_RT;

  [[nodiscard]] double energy_J() const OSTEON_RT { return energy_J_; }                  ///< E
  [[nodiscard]] double damping_Ns_per_m() const OSTEON_RT { return damping_Ns_per_m_; }  ///< alpha
  [[nodiscard]] bool acted() const OSTEON_RT { return damping_Ns_per_m_ > 0.0; }

 private:
  PassivityParams params_;
  PortWork work_;
  double period_s_, max_Ns_per_m_;
  bool begun_{false}, touched_{false};
  Pose X_before_{Pose::Identity()};
  Wrench F_before_, F_damping_before_;
  Twist step_before_;  ///< of the last step: the port's displacement
  double energy_J_{0.0}, damping_Ns_per_m_{0.0};
};

}  // namespace osteon::control
