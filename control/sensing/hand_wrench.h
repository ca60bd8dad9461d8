#pragma once

#include "base/marker.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// The force sensor on the flange, and the load on its tool side.
struct ForceSensorParams {
  PlainPose X_FS{};                ///< pose in F of the sensor frame S, as the manufacturer defines S
  double tool_mass_kg{0.0};        ///< mass on the sensor's tool side
  PlainVector3 tool_center_F_m{};  ///< centre of mass of tool_mass_kg, in F
  PlainWrench bias_S{};            ///< reading of the unloaded sensor, in S
  /// Inertia about the centre of mass, along F's axes [kg m^2]. Zero if unknown: the torque of the rotational
  /// inertia is then not compensated.
  PlainInertia tool_inertia_F{};
  /// Share of the tool's inertial force that is compensated, 0 … 1. tool_inertia.h explains its bound.
  double inertia_share{0.0};
  double acceleration_hz{15.0};  ///< corner of both low-pass filters on the tool's estimated acceleration
};

/// @throws std::invalid_argument naming the field, the value and what is accepted.
void Validate(const ForceSensorParams& params);

/// The tool's weight as it appears in the sensor's reading: at S's origin, in S.
[[nodiscard]] Wrench ToolWeight(const ForceSensorParams& params, const Pose& X_WF) OSTEON_RT;

/// Computes the hand's wrench on the tool from the sensor's reading: removes the tool's weight and moves the
/// wrench to the tool's origin.
///
///     (f_S, t_S) = F_S - bias               at S's origin, in S
///     f = R_WS f_S - m g
///     t = R_WS t_S + (p_WS - p_WT) x R_WS f_S - (p_Wc - p_WT) x m g
///
/// with the mass m = tool_mass_kg, its centre c, and g = kGravity_W.
///
/// The result still includes the tool's inertial force, which the caller removes by adding InertiaWrench
/// (tool_inertia.h).
///
/// @param F_S  the sensor's reading  @param X_WF  flange in world  @param p_WT  tool's origin in world [m]
/// @returns F_T_W, at the tool's origin, in W.
[[nodiscard]] Wrench HandWrench(const ForceSensorParams& params, const Wrench& F_S, const Pose& X_WF,
                                const Vector3& p_WT) OSTEON_RT;

}  // namespace osteon::control
