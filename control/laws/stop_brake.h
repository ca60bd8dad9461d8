#pragma once

#include "base/marker.h"
#include "control/laws/impedance_law.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// The brake of a stop under the impedance law: damping and braking toward standstill, at a share of their
/// gains. Its wrench acts through the arm's delay, so gains that hold a tool with a hand on it shake a tool
/// without one. The share is halved each time the tool is found to move against its last motion, and grows no
/// more until the next stop; the arm's own spring and damping stop the rest.
class StopBrake {
 public:
  /// Begins a stop.
  void Reset() OSTEON_RT;
  /// Call once per tick of the stop. @param V_WT  measured velocity of T at To, in W
  /// @returns the wrench on the tool at To, in W, not limited
  [[nodiscard]] Wrench Step(const ImpedanceParams& params, const Matrix3& R_WT, const Twist& V_WT) OSTEON_RT;
  /// Acting share of the gains, 0 … 1.
  [[nodiscard]] double share() const OSTEON_RT { return share_; }

 private:
  Twist V_before_WT_;
  double share_{1.0};
};

}  // namespace osteon::control
