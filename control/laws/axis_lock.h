#pragma once

#include "base/marker.h"
#include "control/laws/admittance_law.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// Keeps the tool on the line, plane or pose to which its locked axes confine it (AdmittanceParams::locked).
///
/// The law gives a locked axis no velocity. But the small errors of the inverse kinematics and of the joint
/// limits would add up over a long path. Therefore a reference pose moves with the tool on the free axes and
/// stands still on the locked axes. The deviation e of a locked axis from the reference is removed at the
/// velocity
///
///     v_i = e_i / 10 ms,   |v| <= 20 mm/s, |w| <= 0.1 rad/s         for each locked axis of T at the centre
///
/// This feedback uses only the commanded pose, so the arm's lag is not part of its loop. In a tick of
/// duration dt, e is multiplied by (1 - dt / 10 ms). If all rotations are locked, the reference stays exactly
/// on one line (or plane) of the world. If rotations are free, the locked axes turn with the tool.
class AxisLock {
 public:
  /// @param period_s  period of Correction, > 0
  AxisLock(const AdmittanceParams& params, double period_s);

  /// Whether any axis is locked.
  [[nodiscard]] bool any() const OSTEON_RT { return any_; }
  /// Sets the reference pose.
  void Reset(const Pose& X_WT) OSTEON_RT;
  /// Returns the velocity that removes the deviations of the locked axes, at the centre, in T; zero for free
  /// axes. Also moves the reference with the tool. Call once per tick.
  /// @param X_WT  commanded tool pose
  [[nodiscard]] Twist Correction(const Pose& X_WT) OSTEON_RT;

 private:
  Vector3 position_, turn_;  ///< 1 on a locked axis, 0 on a free one
  Vector3 centre_T_m_;
  double return_s_;
  bool any_;
  Pose X_WC_{Pose::Identity()};  ///< the reference pose
};

}  // namespace osteon::control
