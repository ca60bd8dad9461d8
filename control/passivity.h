#pragma once

#include "control/rt/marker.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// Tuning of PassivityController. Every field has a usable default.
struct PassivityParams {
  bool acts{true};  ///< false: the energy is observed and recorded, and nothing is damped
  /// Memory of what was dissipated: so much may come back of it; >= 0. Trapezoids, frames that replace each
  /// other and the coupling's damping, which is a tick old, err by less.
  double allowance_J{0.02};
  double least_speed_m_per_s{0.005};  ///< below it, the quotient is noise: the energy is kept for later; > 0
  double most_damping_Ns_per_m{1000.0};
  double lever_m{0.1};  ///< turning counts as the motion at this lever
};

/// @throws std::invalid_argument naming the field, the value found and what is accepted.
void Validate(const PassivityParams& params);

/// When the force of a tick does its work.
enum class PortWork {
  /// It is the mean of both ends that counts. For a tool that the loop integrates itself (semi-implicit): a
  /// spring then gives back over any closed way what it took, to the last bit; F_k dx would call K dx^2 / 2
  /// of
  /// every tick generated, in and out, at a wall that is stable.
  kTrapezoid,
  /// It is held until the next. For a real arm (impedance law), for which that is so: K dx^2 / 2 a tick
  /// really
  /// is made there.
  kHeld,
};

/// What the coupling exchanges with the tool.
struct PortTick {
  Wrench F_T_W{};           ///< by the planes, as rendered: faded, limited; zero without contact
  double potential_J{0.0};  ///< of it what the planes give back if the tool leaves
  double paid_J{0.0};       ///< into the planes in this tick by an energy tank: may come out
  bool contact{false};
  Pose X_WT{Pose::Identity()};  ///< where the force acts
  Twist V_WT{};                 ///< there; what the damping is told
};

/// Passivity observer and controller on the coupling's port, over six axes:
///
///     E += F·dx                 energy that the planes have given to the tool; dx of this tick
///     E -= what an energy tank has paid into the planes
///     E  = max(E, -(U + allowance))
///     E > 0:  alpha = E / (T |V|_L^2),  F -= alpha (v, L^2 w),  |V|_L^2 = v^2 + L^2 w^2
///
/// E > 0 is more than what was ever put in: the virtual side has made energy. The damping takes it back, in a
/// tick where speed and bounds allow it, else in some. What was dissipated long ago must not hide what is
/// made now (cutting dissipates for minutes): E remembers only what the planes hold, U, and the allowance.
/// Where contact ends, it begins again, with 2 mJ for the touch itself.
///
/// The damping is bounded: `most_Ns_per_m` of the constructor, so that it can not turn the motion round
/// within a tick (m/T of a virtual tool), and the params'. The sum is for the caller to limit.
///
/// What it can not do: it sees energy only after it has come out, so a first impact is unchanged; nothing at
/// the arm or the hand reaches it; and force that pushes without making energy (planes that are wrong, but
/// rest) is no business of its.
/// Source: control.md of the design; the idea is Hannaford and Ryu, IEEE Trans. Robotics Automation 18, 2002
/// (from memory).
class PassivityController {
 public:
  /// @throws std::invalid_argument as Validate. @param most_Ns_per_m  > 0
  PassivityController(const PassivityParams& params, PortWork work, double period_s, double most_Ns_per_m);

  /// One tick. @returns the damping to add to F; zero where it does not act.
  [[nodiscard]] Wrench Step(const PortTick& port) OSTEON_RT;

  /// As it was constructed.
  void Reset() OSTEON_RT;
  /// Replaces the constructor's bound; > 0. The params' own bound stays in force.
  void SetMaxDamping(double max_Ns_per_m) OSTEON_RT;
  /// Tells that a later limit let only this share of the last step's force and damping through, 0 … 1: the
  /// energy is counted with what was rendered.
  void ScaleRendered(double share) OSTEON_RT;

  [[nodiscard]] double energy_J() const OSTEON_RT { return energy_J_; }                  ///< E
  [[nodiscard]] double damping_Ns_per_m() const OSTEON_RT { return damping_Ns_per_m_; }  ///< alpha
  [[nodiscard]] bool acted() const OSTEON_RT { return damping_Ns_per_m_ > 0.0; }

 private:
  PassivityParams params_;
  PortWork work_;
  double period_s_, most_Ns_per_m_;
  bool begun_{false}, touched_{false};
  Pose X_before_{Pose::Identity()};
  Wrench F_before_, F_damping_before_;
  Twist step_before_;  ///< of the last step: how far the port moved
  double energy_J_{0.0}, damping_Ns_per_m_{0.0};
};

}  // namespace osteon::control
