#pragma once

#include "control/rt/marker.h"
#include "control/virtual_coupling.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// Tuning of AgeGovernor. Every field has a usable default.
struct AgeGovernorParams {
  bool acts{true};  ///< false: neither damping nor coupling is touched, and the figures stay 1
  /// Times the law's damping, at most; >= 1. What this does not cover is taken from the coupling.
  double most_damping{20.0};
  double release_s{0.2};        ///< time constant with which it lets go; it acts at once
  double tool_radius_m{0.025};  ///< R: the tool's, where it touches
  /// Impedance law: the arm's own damping that is counted on, in every direction; 0: none.
  double arm_damping_Ns_per_m{0.0}, arm_damping_Nms_per_rad{0.0};
};

/// @throws std::invalid_argument naming the field, the value found and what is accepted.
void Validate(const AgeGovernorParams& params);

/// A damping by axis of T, at a point C of it; > 0.
struct AxisDamping {
  Vector3 Ns_per_m{Vector3::Ones()};
  Vector3 Nms_per_rad{Vector3::Ones()};
  Vector3 centre_T_m{Vector3::Zero()};  ///< C, from T's origin
};

/// How old what acts is.
struct StiffnessAges {
  double pose_s{0.0};    ///< of the pose that the planes are evaluated at
  double planes_s{0.0};  ///< of the planes
};

/// How much damping the coupling's stiffness asks for by its age, as a multiple of D:
///
///     ratio >= largest lambda with det(1.02 sum a_i K_i - lambda D) = 0
///
/// so that ratio D - 1.02 sum a_i K_i >= 0 over all six axes, lever arms included. Two stiffnesses are old:
///
///     K_1 = k A (N^T N)^-1 A^T         of the planes, N = [n_j], A = [n_j; r_j x n_j]; age of the pose
///     K_2 = sum f_j/R B_j P B_j^T      of their turning, P = 1 - N (N^T N)^-1 N^T; age of the planes
///
/// K_2: along a curved surface the normal of a tool of radius R turns by dx/R, and the force with it; planes
/// of a frame do not. It counts at the tool's centre (r + R n) and only across the normals: where planes
/// stand, they say themselves how the surface goes on. f/R counts as k at most. That the surface gives way
/// under force (advance) is left out: K (K advance/f) a, in the demo's frames at most 300 N/m at their 3 ms,
/// against 4 800 N/m of turning.
///
/// Source: AgeReserve of hil/stability and control.md of the design. At most four directions are involved;
/// the bound is the sixteenth root of the trace of the sixteenth power of their Gram matrix: never below
/// the eigenvalue, and 9 % above it at most.
/// @param R_WT  of the tool  @param radius_m  R > 0
/// @returns a bound >= 0; where it is below 1 it may be coarser.
[[nodiscard]] double AgeRatio(const CouplingOutput& coupling, const Matrix3& R_WT, const AxisDamping& D,
                              const StiffnessAges& ages, double radius_m) OSTEON_RT;

/// Keeps D > a K, which no age below a can make unstable, whatever the inertia: raises the law's damping
/// while what acts is old, and where that does not do takes the rest from the coupling.
///
///     ratio r = AgeRatio:   damping × min(r, most_damping),   coupling × min(1, most_damping / r)
///
/// With the admittance law planes are evaluated in the tick at a pose that has no age, so the stiffness of
/// the planes themselves asks for nothing (20 N/mm at 20 ms would ask for 400 N s/m). With the impedance law
/// it counts from the measured pose.
///
/// What it can not do: it knows nothing of a hand, of the arm's lag, or of planes that are wrong. Where it
/// takes from the coupling the force has a ceiling, and who pushes harder sinks in.
class AgeGovernor {
 public:
  /// @throws std::invalid_argument as Validate.
  AgeGovernor(const AgeGovernorParams& params, double period_s);

  /// One tick. @param law  the law's own damping, >= 0; with the arm's > 0
  void Step(const CouplingOutput& coupling, const Matrix3& R_WT, const AxisDamping& law,
            const StiffnessAges& ages) OSTEON_RT;

  /// As it was constructed.
  void Reset() OSTEON_RT;

  [[nodiscard]] double damping_factor() const OSTEON_RT { return damping_factor_; }  ///< >= 1
  [[nodiscard]] double wrench_share() const OSTEON_RT { return wrench_share_; }      ///< 0 … 1
  [[nodiscard]] bool acted() const OSTEON_RT { return damping_factor_ > 1.0 || wrench_share_ < 1.0; }

 private:
  AgeGovernorParams params_;
  double release_;  ///< share of the way back that a tick goes
  double damping_factor_{1.0}, wrench_share_{1.0};
};

}  // namespace osteon::control
