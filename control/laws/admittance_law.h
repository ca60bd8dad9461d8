#pragma once

#include <array>

#include "base/marker.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// Virtual tool: inertia and drag about a point of the tool, for each axis of T. Every field has a usable
/// default.
///
/// The rotational defaults suit a hand of at most 3 kN/m, 60 N s/m and 3 kg that holds the tool 0.25 m above
/// its apex. At that height they act like a mass of about 2.4 kg and a drag of about 24 N s/m.
struct AdmittanceParams {
  Vector3 mass_kg{3.0, 3.0, 3.0};
  Vector3 inertia_kg_m2{0.15, 0.15, 0.15};
  Vector3 damping_Ns_per_m{20.0, 20.0, 20.0};
  Vector3 damping_Nms_per_rad{1.5, 1.5, 1.5};
  double dead_zone_N{0.0};   ///< dead zone of the operator's force
  double dead_zone_Nm{0.0};  ///< dead zone of the operator's torque
  /// Position in T of the point C to which inertia and drag refer, e.g. the handle. A push at C along an axis
  /// moves the tool only along this axis and does not turn it. At To, inertia and drag are full 6x6 matrices
  /// (MassMatrix).
  Vector3 centre_T_m{Vector3::Zero()};
  /// Locked axes: motion of C along x, y, z of T, then the rotations about them.
  std::array<bool, 6> locked{};
};

/// @throws std::invalid_argument naming the field, unless inertias and damping are > 0, dead zones >= 0, and
///   the centre is within 10 m of the origin.
void Validate(const AdmittanceParams& params);

/// Reduces force and torque of the operator's wrench by the dead zones. The directions stay. A force or
/// torque inside its dead zone becomes zero, and the result changes continuously.
[[nodiscard]] Wrench SubtractDeadZone(const AdmittanceParams& params, const Wrench& F_T_W) OSTEON_RT;

/// Returns the virtual tool with inertia and drag multiplied by factors > 0.
[[nodiscard]] AdmittanceParams ScaleLaw(const AdmittanceParams& params, double mass_factor,
                                        double damping_factor) OSTEON_RT;

/// Velocity of the virtual tool after its inertia was multiplied by `ratio`. The kinetic energy never grows:
/// if the tool gets heavier, it keeps its energy, V / sqrt(ratio); if it gets lighter, it keeps its velocity.
[[nodiscard]] Twist AfterMassChange(const Twist& V_WT, double ratio) OSTEON_RT;
/// The same for a change in which each axis of T has its own ratio. The centre must not change.
[[nodiscard]] Twist AfterMassChange(const AdmittanceParams& before, const AdmittanceParams& after,
                                    const Matrix3& R_WT, const Twist& V_WT) OSTEON_RT;

/// Inputs of NextTwist.
struct NextTwistInput {
  const Pose& X_WT;  ///< tool pose; must outlive the call
  Twist V_WT{};      ///< velocity of T at To, in W
  Wrench F_T_W{};    ///< sum of all wrenches on T at To, in W
  double dt_s{0.0};  ///< period
  Twist V_held_C{};  ///< velocity that the locked axes get, at C, in T
};

using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Inertia and drag of the virtual tool at To, in T, without locked axes: A^T diag A. A maps the motion of To
/// to that of C,
///
///     v_C = v + w × c,   w_C = w
///
/// Translation comes first, then rotation. Symmetric and positive definite.
[[nodiscard]] Matrix6 MassMatrix(const AdmittanceParams& params);
[[nodiscard]] Matrix6 DampingMatrix(const AdmittanceParams& params);

/// Computes the velocity of the virtual tool after one period.
///
///     (M + dt D) V+ = M V + dt F                M, D at To: MassMatrix, DampingMatrix
///
/// M and D are diagonal at C. There the equation separates into one equation per axis and is solved exactly,
/// without a factorisation. m and b are the axis' mass and drag, or inertia and rotational drag:
///
///     v_C = v + w × c_,  t_C = t - c × f        by axis of T at C:  v+ = (v + (dt/m) F) / (1 + (dt/m) b)
///
/// c is the vector from To to C. c_ is the same vector one period earlier, at the begin of the period to
/// which V belongs. The tool has turned since then: if c were used instead of c_, a centrifugal force m w^2 c
/// would drive C outward and create energy.
///
/// The step is implicit in the damping and explicit in the force. Together with IntegratePose it is the
/// semi-implicit Euler scheme. For each axis at C, |v+| <= max(|v|, |F|/b) for any dt, so that V+^T M V+ <=
/// sum m max(|v|, |F|/b)^2. Without a force, kinetic energy never grows.
///
/// A locked axis gets the velocity given for it. Forces do not move it, and its motion exerts no force on
/// other axes.
///
/// @param[out] V_next_WT  the new velocity, in W; unchanged if the result would not be finite
/// @returns false if the result would not be finite
[[nodiscard]] bool NextTwist(const AdmittanceParams& params, const NextTwistInput& input,
                             Twist& V_next_WT) OSTEON_RT;

/// Moves a pose with a velocity for one period: p + dt v, exp(dt w) R, with R orthonormalised.
[[nodiscard]] Pose IntegratePose(const Pose& X_WT, const Twist& V_WT, double dt_s) OSTEON_RT;

struct AdmittanceState {
  Pose X_WT{Pose::Identity()};
  Twist V_WT;
};

/// One step of velocity and pose, without limiting the velocity.
/// @returns false, with the state unchanged, if the result would not be finite
[[nodiscard]] bool StepAdmittance(const AdmittanceParams& params, const Wrench& F_T_W, double dt_s,
                                  AdmittanceState& state) OSTEON_RT;

}  // namespace osteon::control
