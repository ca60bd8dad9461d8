#pragma once

#include "control/admittance_law.h"
#include "control/rt/marker.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// Draws the tool back onto the line, plane or pose that its locked axes leave it (AdmittanceParams::locked).
///
/// The law gives a locked axis no velocity; what the inverse kinematics and the joints' limits leave of it
/// would add up over a long way. So a reference pose goes along, on the free axes as far as the tool has
/// moved, on the locked ones not at all. What the tool is off by there comes back as
///
///     v_i = e_i / 10 ms,   |v| <= 20 mm/s, |w| <= .1 rad/s         by locked axis of T at the centre
///
/// It acts on the commanded motion alone, so that the arm's lag is not in its loop: a factor 1 - dt / 10 ms a
/// tick. With all turns locked the reference stays on one exact line (or plane) of the world, however long;
/// where some are free the axes turn with the tool.
class AxisLock {
 public:
  /// @param period_s  of Correction, > 0
  AxisLock(const AdmittanceParams& params, double period_s);

  [[nodiscard]] bool any() const OSTEON_RT { return any_; }
  /// What the tool is held to from here on.
  void Reset(const Pose& X_WT) OSTEON_RT;
  /// Velocity of the locked axes that draws the tool back, at the centre, in T; zero on free axes. The
  /// reference goes along.
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
