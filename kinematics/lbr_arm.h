#pragma once

#include <array>
#include <numbers>

#include "kinematics/chain_params.h"
#include "kinematics/spatial.h"

namespace osteon::kinematics {

using JointVector = Eigen::Matrix<double, 7, 1>;  ///< q, qd … of an LBR [rad, rad/s …]
using Jacobian = Eigen::Matrix<double, 6, 7>;     ///< rows: v (3) then w (3)

/// Limits of the iiwa 14 R820 for A1 … A7: KUKA's data sheet; accelerations as Drake uses them.
inline constexpr std::array<JointLimits, 7> kIiwa14Limits = [] {
  constexpr double rad = std::numbers::pi / 180.0;
  return std::array<JointLimits, 7>{JointLimits{-170 * rad, 170 * rad, 85 * rad, 8.57, 320.0},
                                    JointLimits{-120 * rad, 120 * rad, 85 * rad, 8.57, 320.0},
                                    JointLimits{-170 * rad, 170 * rad, 100 * rad, 8.74, 176.0},
                                    JointLimits{-120 * rad, 120 * rad, 75 * rad, 11.36, 176.0},
                                    JointLimits{-170 * rad, 170 * rad, 130 * rad, 12.23, 110.0},
                                    JointLimits{-120 * rad, 120 * rad, 135 * rad, 15.72, 40.0},
                                    JointLimits{-175 * rad, 175 * rad, 135 * rad, 15.72, 40.0}};
}();

/// Geometry and limits of a KUKA LBR (spherical-revolute-spherical, no lateral offsets). Defaults: iiwa 14
/// R820. Source: lbr_description; limits as in KUKA's data sheet; accelerations as Drake uses them.
struct LbrParams {
  double base_to_shoulder_m{0.360};
  double shoulder_to_elbow_m{0.420};
  double elbow_to_wrist_m{0.400};
  double wrist_to_flange_m{0.126};
  std::array<JointLimits, 7> limits{kIiwa14Limits};
};

/// Kinematics of an LBR iiwa. Allocation-free.
///
/// Joints A1 … A7 turn about z, y, z, -y, z, y, z; zero is the arm stretched upwards:
///
///     X_BF = Rz(q1) Tz(d_bs) Ry(q2) Rz(q3) Tz(d_se) R-y(q4) Rz(q5) Tz(d_ew) Ry(q6) Rz(q7) Tz(d_wf)
///
/// A1 A2 A3 meet in the shoulder, A4 is the elbow, A5 A6 A7 meet in the wrist. With shoulder and wrist held,
/// the elbow can still travel on a circle about the line between them: the arm angle says where on the circle
/// it is.
class LbrArm {
 public:
  explicit LbrArm(const LbrParams& params) : params_(params) {}

  [[nodiscard]] const LbrParams& params() const noexcept { return params_; }

  /// X_BF of joint positions q [rad].
  [[nodiscard]] Pose FlangePose(const JointVector& q) const noexcept;

  /// Geometric Jacobian of the flange's origin, in B: V_BF = J qd, rows v then w.
  [[nodiscard]] Jacobian FlangeJacobian(const JointVector& q) const noexcept;

  /// Arm angle [rad], -pi … pi: where the elbow is on its circle, as the right-handed angle about the line
  /// from shoulder to wrist, counted from the circle's highest point. So it is 0 where q3 = 0 and the elbow
  /// is up, pi where it hangs. Where the line is vertical it is counted from +x of B; where the arm is
  /// straight it is 0.
  [[nodiscard]] double ArmAngle(const JointVector& q) const noexcept;

  /// Closed-form inverse: joint positions that put the flange at X_BF with the given arm angle, the nearest
  /// to `seed` (sum of squared joint differences) of the (at most eight: signs of q2, q4, q6) solutions
  /// within the position limits. A joint that a singularity leaves free (A1 with the upper arm vertical, A3
  /// with the arm straight, A5 with the wrist straight) stays at its seed. False where there is none: out of
  /// reach, all beyond a limit, or an input that is not finite; q is then unchanged. `q` may be the same
  /// object as `seed`. Source: Shimizu et al., Analytical Inverse Kinematic Computation for 7-DOF Redundant
  /// Manipulators With Joint Limits, IEEE Trans. Robotics 24 (5), 2008; the reference direction is the
  /// vertical's instead of the q3 = 0 arm's, so that the angle fixes the elbow's place whatever the signs of
  /// q2 and q4.
  [[nodiscard]] bool Inverse(const Pose& X_BF, double arm_angle_rad, const JointVector& seed,
                             JointVector& q) const noexcept;

 private:
  LbrParams params_;
};

}  // namespace osteon::kinematics
