#pragma once

#include <span>
#include <string>

#include <tl/expected.hpp>

#include "kinematics/spatial.h"

// What hangs on the flange, measured with the arm itself: from poses at rest. Set-up code, not for the tick.

namespace osteon::control {

/// The arm at rest and nobody at the handle.
struct RestPose {
  Matrix3 R_WS{Matrix3::Identity()};  ///< force sensor in world
  Wrench F_S;                         ///< its mean reading, at S, in S
};

/// What the force sensor carries, and what it reads with nothing on it.
struct PayloadFit {
  double mass_kg{0.0};
  Vector3 center_S_m{Vector3::Zero()};  ///< of mass, in S
  Wrench bias_S;
  double residual_N{0.0}, residual_Nm{0.0};  ///< rms over poses and components
  double mass_sd_kg{0.0}, center_sd_m{0.0};  ///< standard deviations that follow from the residuals
};

/// Least squares of
///
///     f_S = b_f + m R_SW g          t_S = b_t + c × (m R_SW g)
///
/// first of the forces (m, b_f), then of the torques (m c, b_t). The poses have to turn the sensor about two
/// axes at least: with gravity always along one line of S, bias and weight can not be told apart.
/// @returns the error that says what the poses lack: fewer than 4, directions of gravity that do not differ,
/// a mass below 1 g, values that are not finite.
[[nodiscard]] tl::expected<PayloadFit, std::string> FitPayload(std::span<const RestPose> poses);

/// Where a tool's tip is, on the flange.
struct PivotFit {
  Vector3 p_FT_m{Vector3::Zero()};  ///< the tip in the flange's frame
  Vector3 p_WT_m{Vector3::Zero()};  ///< the point that it stood on
  double residual_m{0.0};           ///< rms over the poses
  double worst_m{0.0};              ///< of a pose
  double sd_m{0.0};                 ///< standard deviation of p_FT along its worst direction
};

/// Least squares of R_i p_FT + p_i = p_WT over the flange's poses X_WF with the tip held on one point.
/// @returns the error that says what they lack: fewer than 4, turns that do not differ by some 20 deg about
/// two axes.
[[nodiscard]] tl::expected<PivotFit, std::string> FitPivot(std::span<const Pose> X_WF);

}  // namespace osteon::control
