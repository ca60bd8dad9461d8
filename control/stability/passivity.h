#pragma once

#include "base/marker.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// Tuning of PassivityController. Every field has a usable default.
struct PassivityParams {
  bool acts{true};  ///< false: the energy is observed and recorded, but no damping is added
  /// Dissipated energy that the observer remembers and lets the planes give back; >= 0. It must exceed the
  /// errors of the observed energy: of the trapezoidal sum, of changes between frames, and of the coupling's
  /// damping, which is one tick old.
  double allowance_J{0.02};
  /// Below this speed no damping acts and E is kept, because E / |V|^2 would be noise; > 0.
  double min_speed_m_per_s{0.005};
  double max_damping_Ns_per_m{1000.0};
  double lever_m{0.1};  ///< L: length that converts rotation to translation
};

/// @throws std::invalid_argument naming the field, the value found and what is accepted.
void Validate(const PassivityParams& params);

/// How the work of a tick's force is summed.
enum class PortWork {
  /// Work with the mean of the forces at the start and at the end of a step. For a tool whose motion the loop
  /// integrates itself (admittance law): over any closed path, a spring then returns exactly the energy that
  /// it took. With the force at the start alone, a stable wall would seem to generate K dx^2 / 2 per tick in
  /// both directions.
  kTrapezoid,
  /// Work with the force at the start of a step. For a real arm (impedance law): the arm holds the force
  /// until the next tick, so a spring really generates K dx^2 / 2 per tick.
  kHeld,
};

/// The coupling's port in a tick: force, motion and energy exchanged with the tool.
struct PortTick {
  Wrench F_T_W{};           ///< rendered wrench of the planes: faded, limited; zero without contact
  double potential_J{0.0};  ///< U: stored energy that the planes give back if the tool leaves them
  double paid_J{0.0};  ///< energy that the tank paid into the planes in this tick; the planes may give it out
  bool contact{false};
  Pose X_WT{Pose::Identity()};  ///< pose at which the force acts
  Twist V_WT{};                 ///< velocity at that pose, which the damping opposes
};

/// Passivity observer and controller on the coupling's port, over six axes:
///
///     E += F·dx                 energy that the planes have given to the tool; dx: motion in this tick
///     E -= paid                 energy that a tank has paid into the planes
///     E  = max(E, -(U + allowance))
///     E > 0:  alpha = E / (T |V|_L^2),  F -= alpha (v, L^2 w),  |V|_L^2 = v^2 + L^2 w^2
///
/// T is the period. E > 0 means that the planes gave out more energy than was put into them: they have
/// generated energy. The damping dissipates this energy, in one tick if speed and bounds allow, otherwise
/// over several. Cutting dissipates energy for minutes; this energy must not hide energy that is generated
/// later. E is therefore bounded below by the stored energy U and the allowance. Each new contact starts at E
/// = -2 mJ (or at -allowance if that is smaller), a tolerance for the error at its first tick.
///
/// The damping has two bounds: `max_Ns_per_m` of the constructor, so that it cannot reverse the motion within
/// a tick (m/T for a virtual tool of mass m), and the bound in the params. The caller limits the sum of
/// coupling and damping.
///
/// Limits of the method: it detects energy only after it has come out, so a first impact is unchanged. It
/// does not observe arm and hand. It ignores a force that pushes without generating energy (planes that are
/// wrong but at rest). Source: control.md of the design; the idea is Hannaford and Ryu, IEEE Trans. Robotics
/// Automation 18, 2002 (from memory).
class PassivityController {
 public:
  /// @throws std::invalid_argument as Validate. @param max_Ns_per_m  > 0
  PassivityController(const PassivityParams& params, PortWork work, double period_s, double max_Ns_per_m);

  /// One tick. @returns the damping to add to F; zero while inactive.
  [[nodiscard]] Wrench Step(const PortTick& port) OSTEON_RT;

  /// Returns to the state after construction.
  void Reset() OSTEON_RT;
  /// Replaces the constructor's bound; > 0. The bound in the params still applies.
  void SetMaxDamping(double max_Ns_per_m) OSTEON_RT;
  /// Reports that a later limit passed only this share of the last step's force and damping, 0 … 1. The
  /// observer then sums the energy of the wrench that was really rendered.
  void ScaleRendered(double share) OSTEON_RT;

  [[nodiscard]] double energy_J() const OSTEON_RT { return energy_J_; }                  ///< E
  [[nodiscard]] double damping_Ns_per_m() const OSTEON_RT { return damping_Ns_per_m_; }  ///< alpha
  [[nodiscard]] bool acted() const OSTEON_RT { return damping_Ns_per_m_ > 0.0; }

 private:
  PassivityParams params_;
  PortWork work_;
  double period_s_, max_Ns_per_m_;
  bool begun_{false}, touched_{false};  ///< there was a previous step; that step had contact
  Pose X_before_{Pose::Identity()};
  Wrench F_before_, F_damping_before_;
  Twist step_before_;  ///< displacement of the port in the last step
  double energy_J_{0.0}, damping_Ns_per_m_{0.0};
};

}  // namespace osteon::control
