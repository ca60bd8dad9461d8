#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "control/rt/marker.h"
#include "kinematics/lbr_arm.h"

namespace osteon::kinematics {

/// A stretch of arm angles [rad]: -pi <= from < pi, from < to <= from + 2 pi.
struct ArmAngleInterval {
  double from_rad{0.0};
  double to_rad{0.0};
};

/// Where on its circle the elbow may be.
struct ArmAngleIntervals {
  /// Six joints follow the arm angle (A4 does not), each meets each of its two limits at two angles at most:
  /// 24 ends.
  static constexpr int kMost = 12;

  std::array<ArmAngleInterval, kMost> interval;  ///< disjoint, by rising from_rad; the first `count` are set
  int count{0};
  double out_of_reach_m{0.0};  ///< as LbrSolutions::out_of_reach_m

  /// Whether an angle [rad], of any number of turns, is in one of them.
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

/// The arm angles at which the posture of one configuration (0 … 7, LbrArm::Configuration) that reaches X_BF
/// has every joint within its limits. Exact: the ends are roots, not samples.
///
/// With psi the arm angle, every component of the posture's axes is c cos(psi) + s sin(psi) + k, so that a
/// bending joint (A2, A6: its cosine is such a wave) and a turning one (A1, A3, A5, A7: its tangent is the
/// quotient y/x of two) meet a limit theta where one wave has a root:
///
///     z(psi) - cos(theta) = 0            y(psi) cos(theta) - x(psi) sin(theta) = 0
///
/// The roots of all limits cut the circle into arcs, and an arc belongs to an interval where its middle does.
/// That needs none of Shimizu's cases (monotone, cyclic, stationary points), of which the ones with a
/// vanishing discriminant or denominator are where implementations go wrong: a limit that is touched but not
/// passed, or a turning joint that jumps by pi at a singular angle, is an arc like any other. An interval may
/// run through such a jump.
/// @param seed keeps what is free at every arm angle (A1 with the arm straight and vertical, A5 with arm and
///   wrist straight), as in LbrArm::Solve.
/// Source: Shimizu et al. 2008 (lbr_arm.h) for the two kinds of joints.
[[nodiscard]] ArmAngleIntervals FindArmAngleIntervals(
    const LbrArm& arm, const Pose& X_BF, int configuration,
    const JointVector& seed = JointVector::Zero()) OSTEON_RT;

}  // namespace osteon::kinematics
