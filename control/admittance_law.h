#pragma once

#include <array>

#include "control/rt/marker.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// Virtual tool: its inertia and drag by axis of T, as they are at a point of it. Every field has a usable
/// default.
///
/// The rotational defaults match a hand of up to 3 kN/m, 60 N s/m, 3 kg that holds the tool .25 m above its
/// apex: seen from there they are about 2.4 kg and 24 N s/m.
struct AdmittanceParams {
  Vector3 mass_kg{3.0, 3.0, 3.0};
  Vector3 inertia_kg_m2{0.15, 0.15, 0.15};
  Vector3 damping_Ns_per_m{20.0, 20.0, 20.0};
  Vector3 damping_Nms_per_rad{1.5, 1.5, 1.5};
  double dead_zone_N{0.0};   ///< of the operator's force
  double dead_zone_Nm{0.0};  ///< of the operator's torque
  /// Where the values above hold: the point C of T, e.g. the handle, from T's origin. A push at C along an
  /// axis meets that axis' mass alone and turns nothing; at To inertia and drag are full 6x6 (MassMatrix).
  Vector3 centre_T_m{Vector3::Zero()};
  /// Axes that do not move: x y z of C along T's axes, and the turns about them.
  std::array<bool, 6> locked{};
};

/// @throws std::invalid_argument naming the field: inertias must be > 0, damping > 0, dead zones >= 0, the
/// centre within 10 m of the origin.
void Validate(const AdmittanceParams& params);

/// The operator's wrench past the dead zone: shortened by it, direction kept, zero inside; continuous.
[[nodiscard]] Wrench PastDeadZone(const AdmittanceParams& params, const Wrench& F_T_W) OSTEON_RT;

/// The same virtual tool with its inertia and its drag multiplied; both factors > 0.
[[nodiscard]] AdmittanceParams Times(const AdmittanceParams& params, double mass_factor,
                                     double damping_factor) OSTEON_RT;

/// How fast the virtual tool is once its inertia is `ratio` times what it was. Kinetic energy never grows by
/// it: where it gets heavier the energy stays, V / sqrt(ratio), and where it gets lighter the velocity.
[[nodiscard]] Twist AfterMassChange(const Twist& V_WT, double ratio) OSTEON_RT;
/// The same where each axis changes by itself: by axis of T, at the centre, which is the same for both.
[[nodiscard]] Twist AfterMassChange(const AdmittanceParams& before, const AdmittanceParams& after,
                                    const Matrix3& R_WT, const Twist& V_WT) OSTEON_RT;

using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Inertia and drag of the free tool at To, in T: A^T diag A, with A the motion of C by that of To,
///
///     v_C = v + w × c,   w_C = w
///
/// Rows and columns: force or velocity first, torque or turn next. Symmetric and positive definite.
[[nodiscard]] Matrix6 MassMatrix(const AdmittanceParams& params);
[[nodiscard]] Matrix6 DampingMatrix(const AdmittanceParams& params);

/// Velocity of the virtual tool after one period.
///
///     (M + dt D) V+ = M V + dt F                M, D at To: MassMatrix, DampingMatrix
///
/// Both are diagonal at C, so the axes at C are the modes of the pair (D, M), whatever factors multiply the
/// two, and the equation is solved exactly without factorising it:
///
///     v_C = v + w × c_,  t_C = t - c × f        by axis of T at C:  v+ = (v + (dt/m) F) / (1 + (dt/m) b)
///
/// c_ is c as it was when V began: the tool has turned since, and a velocity of To that was just kept would
/// throw the centre outward, m w^2 c, and make energy. Implicit in the damping, explicit in the force: with
/// Move below the semi-implicit scheme of Model B in the design's stability page. At C, by axis, |v+| is
/// bounded by max(|v|, |F|/b), whatever dt, so that V+^T M V+ <= sum m max(|v|, |F|/b)^2; without a force
/// kinetic energy only falls.
///
/// A locked axis has the velocity that it is held with and feels no force, and no other axis feels it.
///
/// @param X_WT  tool pose  @param V_WT  velocity of T at To, in W  @param F_T_W  sum of all wrenches on T at
/// To, in W
/// @param[out] V_next_WT  the new velocity, in W; unchanged where the result would not be finite
/// @param V_held_C  of the locked axes, at C, in T
/// @returns false where it would not be finite
[[nodiscard]] bool NextTwist(const AdmittanceParams& params, const Pose& X_WT, const Twist& V_WT,
                             const Wrench& F_T_W, double dt_s, Twist& V_next_WT,
                             const Twist& V_held_C = {}) OSTEON_RT;

/// The pose after moving with a velocity for one period: p + dt v, exp(dt w) R; R is made orthonormal again.
[[nodiscard]] Pose Move(const Pose& X_WT, const Twist& V_WT, double dt_s) OSTEON_RT;

struct AdmittanceState {
  Pose X_WT{Pose::Identity()};
  Twist V_WT;
};

/// One whole step, without limits between velocity and pose. False, and the state held, where it would not be
/// finite.
[[nodiscard]] bool StepAdmittance(const AdmittanceParams& params, const Wrench& F_T_W, double dt_s,
                                  AdmittanceState& state) OSTEON_RT;

}  // namespace osteon::control
