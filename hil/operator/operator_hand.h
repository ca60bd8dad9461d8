#pragma once

#include <cstdint>

#include "hil/operator/hand_script.h"
#include "hil/operator/hand_spring.h"
#include "hil/operator/operator_incidents.h"
#include "hil/operator/tremor.h"
#include "kinematics/spatial.h"

namespace osteon::hil {

/// Parameters of the operator's arm and grip. Published values of human arms: stiffness 50 … 10000 N/m,
/// damping 2 … 80 N s/m, mass 0.3 … 4 kg.
struct OperatorHandParams {
  double stiffness_N_per_m{2000.0};
  double damping_Ns_per_m{60.0};
  double mass_kg{1.5};
  double stiffness_Nm_per_rad{20.0};
  double damping_Nms_per_rad{0.8};
  double inertia_kgm2{0.01};
  double grip_time_s{0.005};  ///< time constant with which the hand's mass follows the handle
  double max_force_N{150.0};  ///< largest force of the hand; a larger force is scaled down to it
  double max_torque_Nm{10.0};
  double tremor_N{0.0};  ///< peak of the tremor's force along each axis; 0: none
  std::uint64_t tremor_seed{1};
  HandIncidents incidents{};  ///< events that disturb the script; none by default

  [[nodiscard]] HandSpring spring() const {
    return {stiffness_N_per_m, damping_Ns_per_m, stiffness_Nm_per_rad, damping_Nms_per_rad};
  }
};

/// Spring and damper between a point of the tool and the hand's target, with the hand's mass: the laws of
/// OperatorHand without script, tremor, incidents and bounds.
class HandImpedance {
 public:
  explicit HandImpedance(const OperatorHandParams& params) : params_(params) {}

  /// Sets the velocity of the hand's mass to 0.
  void Reset() noexcept { V_mass_ = {}; }

  /// Advances by one period. Poses at the point, velocities of the point, all in W. @param period_s > 0
  /// @returns the wrench that the hand exerts, at the point, in W.
  [[nodiscard]] Wrench Step(double period_s, const Pose& X, const Twist& V, const Pose& X_target,
                            const Twist& V_target) noexcept;

  /// Advances the mass alone by one period.
  /// @param grip  0 … 1; scales the damper between mass and handle. At 0 the mass's velocity is set to 0: its
  /// energy is lost and does not return to the handle.
  /// @returns the wrench that accelerates the mass; the mass exerts its negative on the handle.
  [[nodiscard]] Wrench StepMass(double period_s, const Twist& V, double grip) noexcept;

 private:
  OperatorHandParams params_;
  Twist V_mass_;  ///< velocity of the hand's mass, at the point
};

/// Model of a hand that holds the tool and follows a script: an impedance toward the script's target, with a
/// mass.
///
/// The wrench is computed at the centre of the tool's head, which a surgeon guides. (The tool is rigid, so
/// the true position of the grip has no effect.) With n the site's axis (out of the bone) and x the head's
/// centre:
///
///     f = k (x_target - x) + b (v_target - v) - f_mass,   n·f bounded by the script's force limit
///     t = k_r R_WT log(R_T,target) + b_r (w_target - w) - t_mass
///
/// **The push** is limited by the bound on n·f. The script's target lies so deep that the spring would exceed
/// the bound, so along the axis the hand presses with the script's limit. Across the axis the force is the
/// spring's. **The mass's force** f_mass is not computed as mass times measured acceleration, because that
/// would differentiate a measured speed and close a loop of gain mass / virtual mass through the arm's lag.
/// Instead a damper couples the mass to the handle, like flesh. The mass's own speed v_m is the state:
///
///     f_mass = m v_m' = (m / tau) (v - v_m),   tau = grip_time_s
///
/// This is passive for every tau > 0, and acts like a pure mass below 1 / (2 pi tau) = 32 Hz. It is
/// integrated by backward Euler, which is stable and passive at any period. Then f and t are transferred to
/// the tool's origin, scaled by the grip, and limited to max_force_N and max_torque_Nm.
///
/// **The end of the push.** If the script gives the height h_done at which the work is done, the operator
/// watches the height h of the simulated tool. Within the last 0.3 mm above h_done the operator reduces the
/// push by the share s, with a lag of 0.25 s (both assumed):
///
///     n·f >= -limit s,   s' = (clamp((h - h_done) / 0.3 mm, 0, 1) - s) / 0.25 s,   h = head's + push × give
///
/// **Incidents** (operator_incidents.h) change the hand for some time. With c the progress of the return to
/// the script, from 0 to 1, G the remaining grip, and k', b' the incident's spring and damper:
///
///     f = G (k' (x_target - x) + b' (v_target - v)) - f_mass + (1 - c) f_kept
///     |n·f| <= G (max_force + c (force limit - max_force))
///
/// f_kept keeps the wrench continuous at a change of spring, so the change itself causes no motion. Under the
/// same force f, a stiffer spring stores less energy and a softer spring more, by f^2 / 2 (1/k' - 1/k).
/// Muscles supply this energy. The moving target, an incident's jerk, the return to the script and the tremor
/// can also supply energy. Apart from these sources the hand is passive.
class OperatorHand {
 public:
  /// @throws std::invalid_argument on a parameter out of range.
  OperatorHand(const OperatorHandParams& params, HandScript script);

  /// Starts the script, with the tool and the hand at rest.
  void Reset() noexcept;

  /// Advances by one period.
  /// @param time_s since Reset; @param period_s > 0.
  /// @param X_WT pose of the tool; @param V_WT velocity of T, in W.
  /// @returns F_T_W, the wrench that the hand exerts on the tool, at T's origin, in W. |f| <= max_force,
  /// |f·n| <= the script's force limit at time_s, |t| <= max_torque, unless an incident removes a bound.
  /// Finite for finite input.
  [[nodiscard]] Wrench Step(double time_s, double period_s, const Pose& X_WT, const Twist& V_WT) noexcept;

  [[nodiscard]] const HandScript& script() const { return script_; }

 private:
  // State of the tool at the head's centre, where the hand guides it, and the target there.
  struct Handle {
    Vector3 p_T_head_W;
    Pose X, X_target;
    Twist V, V_target;
    Wrench F_mass;  // the wrench that accelerates the hand's mass
    Vector3 tremor_N;
  };
  [[nodiscard]] Handle HandleAt(const HandTarget& target, const Pose& X_WT, const Twist& V_WT) const noexcept;
  // Returns s: the share of the script's force limit with which the hand still pushes near the end of the
  // work.
  [[nodiscard]] double PushShare(double period_s, const HandTarget& target, const Vector3& p_W_head) noexcept;
  // Returns the wrench at the handle: the sum of the wrenches of the spring, of the mass and of the tremor,
  // and of the kept wrench. @param incident the incident whose spring is used; kNone: the hand's own
  [[nodiscard]] Wrench ComputeWrench(std::size_t incident, double grip, const Handle& handle,
                                     const Wrench& kept) const noexcept;
  // Switches to the spring of moment.holding, and sets kept_ so that the wrench is continuous.
  void ChangeSpring(const IncidentMoment& moment, double force_limit_N, const Handle& handle) noexcept;
  [[nodiscard]] bool IsClamp(std::size_t incident) const noexcept;

  OperatorHandParams params_;
  HandScript script_;
  HandImpedance impedance_;  // acts at the head's centre
  Tremor tremor_;
  double pushed_N_{0.0};    // force into the bone along the axis in the last period
  double push_share_{1.0};  // s: share of the script's force limit; below 1 near the end of the work
  std::size_t holding_{IncidentMoment::kNone};  // index of the incident whose spring is used
  Wrench kept_;  // f_kept: added to the spring's wrench so that it is continuous at a change of spring
  Pose X_W_clamped_{Pose::Identity()};  // pose of the head when it was clamped
};

}  // namespace osteon::hil
