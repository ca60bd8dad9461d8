#pragma once

#include "base/marker.h"
#include "control/laws/impedance_law.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// The brake of a stop under the impedance law: the law's damping and brake toward zero velocity, with both
/// gains multiplied by a scale. The wrench acts after the arm's delay. Gains that are stable for a tool in a
/// hand can therefore make a free tool oscillate. Each time the tool reverses its motion, the scale is
/// halved; it does not grow again until the next stop. The arm's own spring and damping stop the remaining
/// motion.
class StopBrake {
 public:
  /// Begins a stop.
  void Reset() OSTEON_RT;
  /// Computes the brake's wrench; call once per tick of the stop. @param V_WT  measured velocity of T at To,
  /// in W
  /// @returns the wrench on the tool at To, in W, not yet limited
  [[nodiscard]] Wrench Step(const ImpedanceParams& params, const Matrix3& R_WT, const Twist& V_WT) OSTEON_RT;

 private:
  Twist V_before_WT_;
  double gain_scale_{1.0};  // scale of the gains in the present tick, 0 … 1
};

}  // namespace osteon::control
