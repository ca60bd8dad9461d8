#pragma once

#include <cstdint>

#include "hil/operator/hand_script.h"
#include "hil/operator/hand_spring.h"
#include "hil/operator/operator_incidents.h"
#include "hil/operator/tremor.h"
#include "kinematics/spatial.h"

namespace osteon::hil {

/// The operator's arm and grip. Published human arms: k 50 … 10000 N/m, b 2 … 80 N s/m, m 0.3 … 4 kg.
struct OperatorHandParams {
  double stiffness_N_per_m{2000.0};
  double damping_Ns_per_m{60.0};
  double mass_kg{1.5};
  double stiffness_Nm_per_rad{20.0};
  double damping_Nms_per_rad{0.8};
  double inertia_kgm2{0.01};
  double grip_time_s{0.005};  ///< time constant with which the hand's mass follows the handle
  double max_force_N{150.0};  ///< largest force of the hand; a larger one is scaled, direction kept
  double max_torque_Nm{10.0};
  double tremor_N{0.0};  ///< peak of the tremor's force along each axis; 0: none
  std::uint64_t tremor_seed{1};
  HandIncidents incidents{};  ///< events beside the script; none by default

  [[nodiscard]] HandSpring spring() const {
    return {stiffness_N_per_m, damping_Ns_per_m, stiffness_Nm_per_rad, damping_Nms_per_rad};
  }
};

/// Spring, damper and mass between a point of the tool and the hand's target: the laws of OperatorHand below,
/// without script, tremor, incidents and bounds.
class HandImpedance {
 public:
  explicit HandImpedance(const OperatorHandParams& params) : params_(params) {}

  /// Sets the hand's mass to rest.
  void Reset() noexcept { V_mass_ = {}; }

  /// Advances by one period. Poses at the point, velocities of the point, all in W. @param period_s > 0
  /// @returns the wrench that the hand exerts, at the point, in W.
  [[nodiscard]] Wrench Step(double period_s, const Pose& X, const Twist& V, const Pose& X_target,
                            const Twist& V_target) noexcept;

  /// Advances the mass alone by one period.
  /// @param grip  0 … 1; scales the damper between mass and handle. At 0 the mass is set to rest: its energy
  ///   is lost, and none returns to the handle.
  /// @returns the wrench that moves the mass: the negative of what the mass exerts.
  [[nodiscard]] Wrench StepMass(double period_s, const Twist& V, double grip) noexcept;

 private:
  OperatorHandParams params_;
  Twist V_mass_;  ///< of the hand's mass, at the point
};

/// A hand that holds the tool and follows a script: an impedance toward the script's target, with a mass.
///
/// The laws act at the centre of the reamer's head, which a surgeon guides (the tool is rigid, so the true
/// place of the grip changes nothing). With n the cup's axis and x the head's centre:
///
///     f = k (x_target - x) + b (v_target - v) - f_mass,   n·f bounded by the script's force limit
///     t = k_r R_WT log(R_T,target) + b_r (w_target - w) - t_mass
///
/// **The push** is that bound: the script's target lies out of reach, so along the axis the hand presses with
/// the script's limit, and across the axis it follows with its spring. **The mass's force** is not computed
/// as mass times measured acceleration: this would differentiate a measured speed, and would close a loop of
/// gain mass / virtual mass through the arm's lag. Instead the mass is coupled to the handle by a damper,
/// like flesh, and its own speed v_m is the state,
///
///     f_mass = m v_m' = (m / tau) (v - v_m),   tau = grip_time_s
///
/// passive for every tau > 0, and a pure mass below 1 / (2 pi tau) = 32 Hz. The step is backward Euler,
/// stable and passive at any period. Then f and t are transferred to the tool's origin, scaled by the grip,
/// and limited to max_force_N and max_torque_Nm.
///
/// **The end of the push.** Where the script says at which height h_done the work is done, the operator
/// watches the height h of the tool that cuts, and lets up within the last 0.3 mm, with the lag of a person
/// who looks (both assumed):
///
///     n·f >= -limit s,   s' = (clamp((h - h_done) / 0.3 mm, 0, 1) - s) / 0.25 s,   h = head's + push × give
///
/// **Incidents** (operator_incidents.h) change the hand for a while. With c the progress of the return to the
/// script, from 0 to 1, and G the remaining grip:
///
///     f = G (k' (x_target - x) + b' (v_target - v)) - f_mass + (1 - c) f_kept
///     |n·f| <= G (max_force + c (force limit - max_force))
///
/// f_kept keeps the wrench continuous across a change of spring, so the change itself moves nothing. A
/// stiffer spring under the same force stores less energy, a softer one more: f^2 / 2 (1/k' - 1/k), which
/// muscles supply. Energy can also come from the moving target, an incident's jerk, the return to the script
/// and the tremor. Apart from these sources the hand is passive.
class OperatorHand {
 public:
  /// @throws std::invalid_argument on a parameter out of range.
  OperatorHand(const OperatorHandParams& params, HandScript script);

  /// Starts the script, with the tool and the hand at rest.
  void Reset() noexcept;

  /// Advances by one period.
  /// @param time_s since Reset; @param period_s > 0.
  /// @param X_WT tool pose; @param V_WT velocity of T, in W.
  /// @returns F_T_W, what the hand exerts on the tool, at T's origin, in W. |f| <= max_force, |f·n| <= the
  ///   script's force limit at time_s, |t| <= max_torque, except for bounds that incidents lift. Finite for
  ///   finite input.
  [[nodiscard]] Wrench Step(double time_s, double period_s, const Pose& X_WT, const Twist& V_WT) noexcept;

  [[nodiscard]] const HandScript& script() const { return script_; }

 private:
  // The tool at the head's centre, where the hand guides it, and its target.
  struct Handle {
    Vector3 p_T_head_W;
    Pose X, X_target;
    Twist V, V_target;
    Wrench F_mass;  // the wrench that moves the hand's mass
    Vector3 tremor_N;
  };
  [[nodiscard]] Handle HandleAt(const HandTarget& target, const Pose& X_WT, const Twist& V_WT) const noexcept;
  // The share of the script's limit with which the hand still pushes, as its head nears the end of the work.
  [[nodiscard]] double PushShare(double period_s, const HandTarget& target, const Vector3& p_W_head) noexcept;
  // The wrench at the handle: the sum of the spring's (the given incident's; kNone: the hand's own), the
  // mass's, the tremor's and the kept wrench.
  [[nodiscard]] Wrench ComputeWrench(std::size_t incident, double grip, const Handle& handle,
                                     const Wrench& kept) const noexcept;
  // Switches to the spring of the moment's incident, and sets the kept wrench for continuity.
  void ChangeSpring(const IncidentMoment& moment, double force_limit_N, const Handle& handle) noexcept;
  [[nodiscard]] bool IsClamp(std::size_t incident) const noexcept;

  OperatorHandParams params_;
  HandScript script_;
  HandImpedance impedance_;  // at the head's centre
  Tremor tremor_;
  double pushed_N_{0.0};                        // along the axis, in the last period
  double push_share_{1.0};                      // share of the script's limit: below 1 near the end of work
  std::size_t holding_{IncidentMoment::kNone};  // the incident whose spring holds the tool
  Wrench kept_;  // added to that spring's wrench, for continuity when the spring changed
  Pose X_W_clamped_{Pose::Identity()};  // where the head was when it was clamped
};

}  // namespace osteon::hil
