#pragma once

#include "control/rt/marker.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// Virtual tool: its inertia and drag, diagonal in T by axis. Every field has a usable default.
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
};

/// @throws std::invalid_argument naming the field: inertias must be > 0, damping > 0, dead zones >= 0.
void Validate(const AdmittanceParams& params);

/// The operator's wrench past the dead zone: shortened by it, direction kept, zero inside; continuous.
[[nodiscard]] Wrench PastDeadZone(const AdmittanceParams& params, const Wrench& F_T_W) OSTEON_RT;

/// The same virtual tool with its inertia and its drag multiplied; both factors > 0.
[[nodiscard]] AdmittanceParams Times(const AdmittanceParams& params, double mass_factor,
                                     double damping_factor) OSTEON_RT;

/// How fast the virtual tool is once its inertia is `ratio` times what it was. Kinetic energy never grows by
/// it: where it gets heavier the energy stays, V / sqrt(ratio), and where it gets lighter the velocity.
[[nodiscard]] Twist AfterMassChange(const Twist& V_WT, double ratio) OSTEON_RT;

/// Velocity of the virtual tool after one period.
///
///     M a + D v = F   by axis of T:   v+ = (v + (dt/m) F) / (1 + (dt/m) b)
///
/// Implicit in the damping, explicit in the force: with Move below the semi-implicit scheme of Model B in the
/// design's stability page. |v+| is bounded by max(|v|, |F|/b) by axis, whatever dt.
///
/// @param X_WT  tool pose  @param V_WT  velocity of T at To, in W  @param F_T_W  sum of all wrenches on T at
/// To, in W
/// @param[out] V_next_WT  the new velocity, in W; unchanged where the result would not be finite
/// @returns false where it would not be finite
[[nodiscard]] bool NextTwist(const AdmittanceParams& params, const Pose& X_WT, const Twist& V_WT,
                             const Wrench& F_T_W, double dt_s, Twist& V_next_WT) OSTEON_RT;

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
