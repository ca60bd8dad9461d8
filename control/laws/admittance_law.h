#pragma once

#include <array>

#include "base/marker.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// Virtual tool: inertia and drag by axis of T, at a point of the tool. Every field has a usable default.
///
/// The rotational defaults suit a hand of at most 3 kN/m, 60 N s/m and 3 kg that holds the tool 0.25 m above
/// its apex: seen from there, they are about 2.4 kg and 24 N s/m.
struct AdmittanceParams {
  Vector3 mass_kg{3.0, 3.0, 3.0};
  Vector3 inertia_kg_m2{0.15, 0.15, 0.15};
  Vector3 damping_Ns_per_m{20.0, 20.0, 20.0};
  Vector3 damping_Nms_per_rad{1.5, 1.5, 1.5};
  double dead_zone_N{0.0};   ///< of the operator's force
  double dead_zone_Nm{0.0};  ///< of the operator's torque
  /// The point C at which the values above hold, e.g. the handle, from T's origin. A push at C along an axis
  /// meets only that axis' mass and turns nothing; at To inertia and drag are full 6x6 (MassMatrix).
  Vector3 centre_T_m{Vector3::Zero()};
  /// Locked axes: x y z of C along T's axes, then the rotations about them.
  std::array<bool, 6> locked{};
};

/// @throws std::invalid_argument naming the field: inertias and damping must be > 0, dead zones >= 0, the
///   centre within 10 m of the origin.
void Validate(const AdmittanceParams& params);

/// Subtracts the dead zone from the operator's wrench: direction kept, zero inside the zone, continuous.
[[nodiscard]] Wrench SubtractDeadZone(const AdmittanceParams& params, const Wrench& F_T_W) OSTEON_RT;

/// Returns the same virtual tool with inertia and drag multiplied; both factors > 0.
[[nodiscard]] AdmittanceParams ScaleLaw(const AdmittanceParams& params, double mass_factor,
                                        double damping_factor) OSTEON_RT;

/// Velocity of the virtual tool after its inertia was multiplied by `ratio`. Kinetic energy never grows: when
/// the tool gets heavier the energy is kept, V / sqrt(ratio); when it gets lighter the velocity is kept.
[[nodiscard]] Twist AfterMassChange(const Twist& V_WT, double ratio) OSTEON_RT;
/// The same for inertias that change by axis of T, at the centre, which must be the same before and after.
[[nodiscard]] Twist AfterMassChange(const AdmittanceParams& before, const AdmittanceParams& after,
                                    const Matrix3& R_WT, const Twist& V_WT) OSTEON_RT;

using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Inertia and drag of the free tool at To, in T: A^T diag A, where A maps the motion of To to that of C,
///
///     v_C = v + w × c,   w_C = w
///
/// Rows and columns: force or velocity first, then torque or rotation. Symmetric and positive definite.
[[nodiscard]] Matrix6 MassMatrix(const AdmittanceParams& params);
[[nodiscard]] Matrix6 DampingMatrix(const AdmittanceParams& params);

/// Computes the velocity of the virtual tool after one period.
///
///     (M + dt D) V+ = M V + dt F                M, D at To: MassMatrix, DampingMatrix
///
/// Both are diagonal at C, so the axes at C are the modes of the pair (D, M), whatever factors multiply the
/// two. The equation is solved exactly, without a factorisation:
///
///     v_C = v + w × c_,  t_C = t - c × f        by axis of T at C:  v+ = (v + (dt/m) F) / (1 + (dt/m) b)
///
/// c_ is c at the time when V began. The tool has turned since: keeping To's velocity unchanged would throw
/// the centre outward with m w^2 c and create energy. The step is implicit in the damping and explicit in the
/// force; with IntegratePose below it is the semi-implicit scheme of Model B in the design's stability page.
/// At C, by axis, |v+| is at most max(|v|, |F|/b) for any dt, so that V+^T M V+ <= sum m max(|v|, |F|/b)^2;
/// without a force kinetic energy only falls.
///
/// A locked axis keeps the velocity given for it. It feels no force and passes none to other axes.
///
/// @param X_WT  tool pose  @param V_WT  velocity of T at To, in W  @param F_T_W  sum of all wrenches on T at
/// To, in W
/// @param[out] V_next_WT  the new velocity, in W; unchanged if the result would not be finite
/// @param V_held_C  velocity of the locked axes, at C, in T
/// @returns false if the result would not be finite
[[nodiscard]] bool NextTwist(const AdmittanceParams& params, const Pose& X_WT, const Twist& V_WT,
                             const Wrench& F_T_W, double dt_s, Twist& V_next_WT,
                             const Twist& V_held_C = {}) OSTEON_RT;

/// Moves a pose with a velocity for one period: p + dt v, exp(dt w) R; R is orthonormalised.
[[nodiscard]] Pose IntegratePose(const Pose& X_WT, const Twist& V_WT, double dt_s) OSTEON_RT;

struct AdmittanceState {
  Pose X_WT{Pose::Identity()};
  Twist V_WT;
};

/// One full step, without limits between velocity and pose. Returns false, with the state unchanged, if the
/// result would not be finite.
[[nodiscard]] bool StepAdmittance(const AdmittanceParams& params, const Wrench& F_T_W, double dt_s,
                                  AdmittanceState& state) OSTEON_RT;

}  // namespace osteon::control
