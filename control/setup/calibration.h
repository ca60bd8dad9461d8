#pragma once

#include <span>
#include <string>

#include <tl/expected.hpp>

#include "kinematics/spatial.h"

// Calibration of the payload on the flange and of the tool centre point, from poses at rest. For set-up, not
// for the tick.

namespace osteon::control {

/// A pose with the arm at rest and nobody at the handle.
struct RestPose {
  Matrix3 R_WS{Matrix3::Identity()};  ///< force sensor in world
  Wrench F_S;                         ///< mean reading, at S, in S
};

/// The load on the force sensor, and the sensor's reading without load.
struct PayloadFit {
  double mass_kg{0.0};
  Vector3 center_S_m{Vector3::Zero()};  ///< centre of mass, in S
  Wrench bias_S;
  double residual_N{0.0}, residual_Nm{0.0};  ///< rms over poses and components
  double mass_sd_kg{0.0}, center_sd_m{0.0};  ///< standard deviations, computed from the residuals
};

/// Least squares of
///
///     f_S = b_f + m R_SW g          t_S = b_t + c × (m R_SW g)
///
/// f_S and t_S are a pose's force and torque, m is the mass, c its centre in S, g gravity, and b_f, b_t is
/// the bias. The forces are solved first (m, b_f), then the torques (m c, b_t). The poses must turn the
/// sensor about at least two axes: if gravity always acts along one line of S, bias and weight cannot be
/// distinguished.
/// @returns the fit, or an error that names the reason: fewer than 4 poses, directions of gravity that do not
///   differ enough, a mass below 1 g, or values that are not finite
[[nodiscard]] tl::expected<PayloadFit, std::string> FitPayload(std::span<const RestPose> poses);

/// Position of a tool's tip on the flange.
struct PivotFit {
  Vector3 p_FT_m{Vector3::Zero()};  ///< the tip in the flange's frame
  Vector3 p_WT_m{Vector3::Zero()};  ///< the fixed point in the world
  double residual_m{0.0};           ///< rms over the poses
  double worst_m{0.0};              ///< largest residual of a pose
  double sd_m{0.0};                 ///< standard deviation of p_FT in the direction in which it is largest
};

/// Least squares of R_i p_FT + p_i = p_WT over the flange's poses X_WF = (R_i, p_i), in all of which the tip
/// is on the same point.
/// @returns the fit, or an error that names the reason: fewer than 4 poses, rotations that do not differ by
///   some 20 deg about two axes, or values that are not finite
[[nodiscard]] tl::expected<PivotFit, std::string> FitPivot(std::span<const Pose> X_WF);

}  // namespace osteon::control
