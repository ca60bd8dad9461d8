#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "base/marker.h"
#include "kinematics/lbr_arm.h"

namespace osteon::kinematics {

/// An interval of arm angles [rad]: -pi <= from < pi, from < to <= from + 2 pi.
struct ArmAngleInterval {
  double from_rad{0.0};
  double to_rad{0.0};
};

/// The arm angles that the joint limits allow.
struct ArmAngleIntervals {
  /// Six joints move with the arm angle (A4 does not). Each of them meets each of its two limits at up to two
  /// arm angles, which gives at most 24 ends.
  static constexpr int kMax = 12;

  std::array<ArmAngleInterval, kMax> interval;  ///< disjoint, by rising from_rad; the first `count` are set
  int count{0};
  double out_of_reach_m{0.0};  ///< as LbrSolutions::out_of_reach_m

  /// Whether an angle [rad], with any number of turns added, is in one of the intervals.
  [[nodiscard]] bool Contains(double arm_angle_rad) const OSTEON_RT {
    constexpr double kTurn = 2.0 * std::numbers::pi;
    for (int i = 0; i < count; ++i) {
      const ArmAngleInterval& a = interval[static_cast<std::size_t>(i)];
      const double turns = std::floor((arm_angle_rad - a.from_rad) / kTurn);
      if (arm_angle_rad - kTurn * turns <= a.to_rad) return true;
    }
    return false;
  }
};

/// Finds the arm angles at which a configuration (0 … 7, LbrArm::Configuration) reaches X_BF with every joint
/// within its limits. Exact: the ends are roots, not samples.
///
/// With psi the arm angle, every component of the posture's axes is a wave c cos(psi) + s sin(psi) + k. The
/// cosine of a bending joint (A2, A6) is such a wave, the tangent of a turning joint (A1, A3, A5, A7) is the
/// quotient y/x of two. A bending joint (left) or a turning joint (right) is at a limit theta if a wave is
/// zero:
///
///     z(psi) - cos(theta) = 0            y(psi) cos(theta) - x(psi) sin(theta) = 0
///
/// The roots of all limits cut the circle into arcs, and an arc belongs to an interval if its middle does.
/// Shimizu distinguishes cases (monotone, cyclic, stationary points), and implementations fail where a
/// discriminant or a denominator vanishes. Here no cases are needed: the middle of an arc is tested in the
/// same way if a limit is touched but not passed, or if a turning joint jumps by pi at a singular angle. An
/// interval may contain such a jump.
/// @param seed value of a joint that is free at every arm angle (A1 with the arm straight and vertical, A5
///   with arm and wrist straight), as in LbrArm::Solve.
/// Source of the formulas of the two kinds of joints: Shimizu et al. 2008 (lbr_arm.h).
[[nodiscard]] ArmAngleIntervals FindArmAngleIntervals(
    const LbrArm& arm, const Pose& X_BF, int configuration,
    const JointVector& seed = JointVector::Zero()) OSTEON_RT;

}  // namespace osteon::kinematics
