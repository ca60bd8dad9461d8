#pragma once

#include "base/marker.h"
#include "control/coupling/virtual_coupling.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// Tuning of AgeGovernor. Every field has a usable default.
struct AgeGovernorParams {
  bool acts{true};  ///< false: both factors stay 1
  /// Largest factor on the law's damping; >= 1. If this is not enough, the coupling is scaled down.
  double max_damping_factor{20.0};
  double release_s{0.2};        ///< time constant of the release; the rise is immediate
  double tool_radius_m{0.025};  ///< R: radius of the tool at the contact
  /// For the impedance law: the arm's own damping, in every direction, that the governor may rely on; 0:
  /// none.
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
/// so that the matrix ratio D - 1.02 sum a_i K_i is positive semidefinite over all six axes. D is the
/// damping, K_i a stiffness and a_i its age. There are two such stiffnesses:
///
///     K_1 = k A (N^T N)^-1 A^T         of the planes, N = [n_j], A = [n_j; r_j x n_j]; a_1: age of the pose
///     K_2 = sum f_j/R B_j P B_j^T      of their rotation, P = 1 - N (N^T N)^-1 N^T; a_2: age of the planes
///
/// k is the coupling's stiffness, n_j, r_j and f_j the normal, lever and force of plane j. K_2: if a tool of
/// radius R moves by dx along a curved surface, the normal and the force turn by dx/R, but the planes of a
/// frame do not turn. K_2 acts at the tool's centre (r + R n) and only perpendicular to all normals, because
/// along the normals the planes describe the surface. f/R is limited to k. The recession of the surface under
/// force (advance) is neglected: K (K advance/f) a is at most 300 N/m in the demo's frames at their 3 ms,
/// compared with 4 800 N/m of K_2.
///
/// Source: AgeReserve of tests/oracles and control.md of the design. The result is an upper bound of lambda:
/// the sixteenth root of the trace of the sixteenth power of a Gram matrix of at most four directions. It is
/// never below lambda, and at most 9 % above it.
/// @param R_WT  orientation of the tool @param radius_m R > 0
/// @returns a bound >= 0; below 1 the bound may be coarser.
[[nodiscard]] double AgeRatio(const CouplingOutput& coupling, const Matrix3& R_WT, const AxisDamping& D,
                              const StiffnessAges& ages, double radius_m) OSTEON_RT;

/// Keeps the damping D above age a times stiffness K. The loop is then stable for every age up to a and for
/// every inertia. The governor raises the law's damping while the coupling's inputs are old, and scales the
/// coupling down if the highest permitted damping is not enough.
///
///     ratio r = AgeRatio:   damping × min(r, max_damping_factor),   coupling × min(1, max_damping_factor / r)
///
/// Under the admittance law the planes are evaluated at a pose without age, so the stiffness of the planes
/// themselves requires no damping (20 N/mm at 20 ms would require 400 N s/m). Under the impedance law the
/// planes are evaluated at the measured pose, whose age requires damping.
///
/// Limits of the method: it takes no account of the hand, of the arm's lag, or of wrong planes. If it scales
/// the coupling down, it limits the force, and a hand that pushes harder moves the tool into the bone.
class AgeGovernor {
 public:
  /// @throws std::invalid_argument as Validate.
  AgeGovernor(const AgeGovernorParams& params, double period_s);

  /// One tick. @param law  the law's own damping, >= 0; its sum with the arm's damping must be > 0
  void Step(const CouplingOutput& coupling, const Matrix3& R_WT, const AxisDamping& law,
            const StiffnessAges& ages) OSTEON_RT;

  /// Returns to the state after construction.
  void Reset() OSTEON_RT;

  [[nodiscard]] double damping_factor() const OSTEON_RT { return damping_factor_; }  ///< >= 1
  [[nodiscard]] double wrench_scale() const OSTEON_RT { return wrench_scale_; }      ///< 0 … 1
  [[nodiscard]] bool acted() const OSTEON_RT { return damping_factor_ > 1.0 || wrench_scale_ < 1.0; }

 private:
  AgeGovernorParams params_;
  double release_;  ///< fraction of the distance to 1 by which a factor is released in a tick
  double damping_factor_{1.0}, wrench_scale_{1.0};
};

}  // namespace osteon::control
