#pragma once

#include "control/rt/marker.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// The force sensor on the flange, and what hangs on its tool side.
struct ForceSensorParams {
  PlainPose X_FS{};                ///< its frame as its maker drew it, in the flange's
  double tool_mass_kg{0.0};        ///< of what it carries
  PlainVector3 tool_center_F_m{};  ///< where that mass has its centre
  PlainWrench bias_S{};            ///< what it reads with nothing on it
  /// About that centre, along F's axes [kg m^2]; zero where it is not known: its torque is then left in.
  PlainInertia tool_inertia_F{};
  /// Of the force that the tool's own inertia takes, the share that is made up for, 0 … 1; 0: none. What it
  /// may be is bounded: tool_inertia.h.
  double inertia_share{0.0};
  double acceleration_hz{15.0};  ///< corner of the two filters that the acceleration goes through
};

/// @throws std::invalid_argument naming the field, the value and what is accepted.
void Validate(const ForceSensorParams& params);

/// What the sensor carries of the tool's weight, as it reads it: at S's origin, in S.
[[nodiscard]] Wrench ToolWeight(const ForceSensorParams& params, const Pose& X_WF) OSTEON_RT;

/// What the hand exerts on the tool, from what the sensor reads: the tool's weight taken out, and moved to
/// the tool's origin.
///
///     f = R_WS f - m g                      g = kGravity_W, (f, t) = F_S - bias
///     t = R_WS t + (p_S - p_T) x R_WS f - (p_c - p_T) x m g
///
/// What accelerates the tool is still in it: InertiaWrench (tool_inertia.h) is added.
///
/// @param F_S  as the sensor reads it  @param X_WF  flange in world  @param p_WT  tool's origin in world [m]
/// @returns F_T_W, at the tool's origin, in W.
[[nodiscard]] Wrench HandWrench(const ForceSensorParams& params, const Wrench& F_S, const Pose& X_WF,
                                const Vector3& p_WT) OSTEON_RT;

}  // namespace osteon::control
