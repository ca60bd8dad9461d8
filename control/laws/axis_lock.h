#pragma once

#include "base/marker.h"
#include "control/laws/admittance_law.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// Returns the tool to the line, plane or pose that its locked axes leave it (AdmittanceParams::locked).
///
/// The law gives a locked axis no velocity, but residuals of the inverse kinematics and of the joint limits
/// would add up over a long path. A reference pose therefore moves with the tool on the free axes and stands
/// still on the locked axes. The deviation e on the locked axes is returned as
///
///     v_i = e_i / 10 ms,   |v| <= 20 mm/s, |w| <= 0.1 rad/s         by locked axis of T at the centre
///
/// It acts on the commanded motion only, so the arm's lag is not in its loop: a factor 1 - dt / 10 ms per
/// tick. With all rotations locked the reference stays exactly on one line (or plane) of the world, over any
/// distance; where some are free, the axes turn with the tool.
class AxisLock {
 public:
  /// @param period_s  of Correction, > 0
  AxisLock(const AdmittanceParams& params, double period_s);

  [[nodiscard]] bool any() const OSTEON_RT { return any_; }
  /// Sets the reference pose.
  void Reset(const Pose& X_WT) OSTEON_RT;
  /// Returns the velocity of the locked axes that leads the tool back, at the centre, in T; zero on free
  /// axes. Moves the reference along.
  /// @param X_WT  commanded
  [[nodiscard]] Twist Correction(const Pose& X_WT) OSTEON_RT;

 private:
  Vector3 position_, turn_;  ///< 1 on a locked axis, 0 on a free one
  Vector3 centre_T_m_;
  double return_s_;
  bool any_;
  Pose X_WC_{Pose::Identity()};  ///< the reference
};

}  // namespace osteon::control
