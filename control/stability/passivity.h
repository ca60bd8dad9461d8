#pragma once

#include "base/marker.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// Tuning of PassivityController. Every field has a usable default.
struct PassivityParams {
  bool acts{true};  ///< false: the energy is observed and recorded, but no damping is added
  /// Dissipated energy that is remembered and may come back; >= 0. Larger than the errors of the trapezoidal
  /// sum, of changes between frames, and of the coupling's damping, which is one tick old.
  double allowance_J{0.02};
  /// Below this speed the energy is kept for later, because E / |V|^2 would be noise; > 0.
  double min_speed_m_per_s{0.005};
  double max_damping_Ns_per_m{1000.0};
  double lever_m{0.1};  ///< lever at which rotation counts as translation
};

/// @throws std::invalid_argument naming the field, the value found and what is accepted.
void Validate(const PassivityParams& params);

/// How the work of a tick's force is summed.
enum class PortWork {
  /// The mean force of both ends of a step counts. For a tool that the loop integrates itself: a spring then
  /// returns, over any closed path, exactly what it took. With the force at the start alone, a stable wall
  /// would seem to generate K dx^2 / 2 per tick in both directions.
  kTrapezoid,
  /// The force at the start of a step counts. For a real arm (impedance law), which holds the force until the
  /// next tick, so that K dx^2 / 2 per tick is really generated.
  kHeld,
};

/// The coupling's port in a tick: force, motion and energy exchanged with the tool.
struct PortTick {
  Wrench F_T_W{};           ///< rendered wrench of the planes: faded, limited; zero without contact
  double potential_J{0.0};  ///< stored energy that the planes give back if the tool leaves
  double paid_J{0.0};       ///< energy that a tank paid into the planes in this tick; it may come out
  bool contact{false};
  Pose X_WT{Pose::Identity()};  ///< pose at which the force acts
  Twist V_WT{};                 ///< velocity at that pose, which the damping opposes
};

/// Passivity observer and controller on the coupling's port, over six axes:
///
///     E += F·dx                 energy that the planes have given to the tool; dx of this tick
///     E -= paid                 energy that a tank has paid into the planes
///     E  = max(E, -(U + allowance))
///     E > 0:  alpha = E / (T |V|_L^2),  F -= alpha (v, L^2 w),  |V|_L^2 = v^2 + L^2 w^2
///
/// E > 0 means that more energy came out than was ever put in: the virtual side has generated energy. The
/// damping takes it back, in one tick if speed and bounds allow, otherwise over several. Cutting dissipates
/// energy for minutes, which must not hide energy generated now. E therefore remembers only the stored energy
/// U and the allowance. Each new contact starts at E = -2 mJ, a tolerance for the touch itself.
///
/// The damping has two bounds: `max_Ns_per_m` of the constructor, so that it cannot reverse the motion
/// within a tick (m/T of a virtual tool), and the params' bound. The caller limits the sum.
///
/// Limits of the method: it detects energy only after it has come out, so a first impact is unchanged. It
/// does not cover arm and hand. It ignores a force that pushes without generating energy (planes that are
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
  /// Replaces the constructor's bound; > 0. The params' own bound stays in force.
  void SetMaxDamping(double max_Ns_per_m) OSTEON_RT;
  /// Reports that a later limit passed only this share of the last step's force and damping, 0 … 1, so that
  /// the energy is that of the rendered wrench.
  void ScaleRendered(double share) OSTEON_RT;

  [[nodiscard]] double energy_J() const OSTEON_RT { return energy_J_; }                  ///< E
  [[nodiscard]] double damping_Ns_per_m() const OSTEON_RT { return damping_Ns_per_m_; }  ///< alpha
  [[nodiscard]] bool acted() const OSTEON_RT { return damping_Ns_per_m_ > 0.0; }

 private:
  PassivityParams params_;
  PortWork work_;
  double period_s_, max_Ns_per_m_;
  bool begun_{false}, touched_{false};  ///< there was a previous step; it had contact
  Pose X_before_{Pose::Identity()};
  Wrench F_before_, F_damping_before_;
  Twist step_before_;  ///< displacement of the port in the last step
  double energy_J_{0.0}, damping_Ns_per_m_{0.0};
};

}  // namespace osteon::control
