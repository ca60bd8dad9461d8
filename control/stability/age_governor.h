#pragma once

#include "base/marker.h"
#include "control/coupling/virtual_coupling.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// Tuning of AgeGovernor. Every field has a usable default.
struct AgeGovernorParams {
  bool acts{true};  ///< false: damping and coupling stay unchanged, and the factors stay 1
  /// Largest factor on the law's damping; >= 1. If this is not enough, the coupling is scaled down.
  double max_damping_factor{20.0};
  double release_s{0.2};        ///< time constant of the release; the rise is immediate
  double tool_radius_m{0.025};  ///< R: radius of the tool where it touches
  /// Impedance law: the arm's own damping that may be relied on, in every direction; 0: none.
  double arm_damping_Ns_per_m{0.0}, arm_damping_Nms_per_rad{0.0};
};

/// @throws std::invalid_argument naming the field, the value found and what is accepted.
void Validate(const AgeGovernorParams& params);

/// Damping by axis of T, at a point C of the tool; > 0.
struct AxisDamping {
  Vector3 Ns_per_m{Vector3::Ones()};
  Vector3 Nms_per_rad{Vector3::Ones()};
  Vector3 centre_T_m{Vector3::Zero()};  ///< C, from T's origin
};

/// Ages of the inputs of the coupling.
struct StiffnessAges {
  double pose_s{0.0};    ///< age of the pose at which the planes are evaluated
  double planes_s{0.0};  ///< age of the planes
};

/// Damping that the coupling's aged stiffness requires, as a multiple of D:
///
///     ratio >= largest lambda with det(1.02 sum a_i K_i - lambda D) = 0
///
/// so that ratio D - 1.02 sum a_i K_i >= 0 over all six axes, lever arms included. Two stiffnesses are aged:
///
///     K_1 = k A (N^T N)^-1 A^T         of the planes, N = [n_j], A = [n_j; r_j x n_j]; age of the pose
///     K_2 = sum f_j/R B_j P B_j^T      of their rotation, P = 1 - N (N^T N)^-1 N^T; age of the planes
///
/// K_2: along a curved surface the normal of a tool of radius R turns by dx/R, and the force with it; the
/// planes of a frame do not turn. K_2 acts at the tool's centre (r + R n) and only across the normals: where
/// there are planes, they describe the surface themselves. f/R counts as at most k. The surface giving way
/// under force (advance) is neglected: K (K advance/f) a is at most 300 N/m in the demo's frames at their 3
/// ms, compared with 4 800 N/m of K_2.
///
/// Source: AgeReserve of tests/oracles and control.md of the design. At most four directions are
/// involved. The bound is the sixteenth root of the trace of the sixteenth power of their Gram matrix: never
/// below the eigenvalue, and at most 9 % above it.
/// @param R_WT  of the tool  @param radius_m  R > 0
/// @returns a bound >= 0; below 1 the bound may be coarser.
[[nodiscard]] double AgeRatio(const CouplingOutput& coupling, const Matrix3& R_WT, const AxisDamping& D,
                              const StiffnessAges& ages, double radius_m) OSTEON_RT;

/// Keeps D > a K, which is stable for every age up to a and every inertia. Raises the law's damping while the
/// coupling's inputs are old, and scales the coupling down where that is not enough.
///
///     ratio r = AgeRatio:   damping × min(r, max_damping_factor),   coupling × min(1, max_damping_factor / r)
///
/// Under the admittance law the planes are evaluated at a pose without age, so the stiffness of the planes
/// themselves requires no damping (20 N/mm at 20 ms would require 400 N s/m). Under the impedance law it
/// counts from the measured pose.
///
/// Limits of the method: it takes no account of the hand, of the arm's lag, or of wrong planes. Where it
/// scales the coupling down the force has a ceiling, and a hand that pushes harder sinks in.
class AgeGovernor {
 public:
  /// @throws std::invalid_argument as Validate.
  AgeGovernor(const AgeGovernorParams& params, double period_s);

  /// One tick. @param law  the law's own damping, >= 0; together with the arm's > 0
  void Step(const CouplingOutput& coupling, const Matrix3& R_WT, const AxisDamping& law,
            const StiffnessAges& ages) OSTEON_RT;

  /// Returns to the state after construction.
  void Reset() OSTEON_RT;

  [[nodiscard]] double damping_factor() const OSTEON_RT { return damping_factor_; }  ///< >= 1
  [[nodiscard]] double wrench_scale() const OSTEON_RT { return wrench_scale_; }      ///< 0 … 1
  [[nodiscard]] bool acted() const OSTEON_RT { return damping_factor_ > 1.0 || wrench_scale_ < 1.0; }

 private:
  AgeGovernorParams params_;
  double release_;  ///< fraction of the remaining release in a tick
  double damping_factor_{1.0}, wrench_scale_{1.0};
};

}  // namespace osteon::control
