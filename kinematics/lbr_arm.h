#pragma once

#include <array>

#include "kinematics/spatial.h"

namespace osteon::kinematics {

using JointVector = Eigen::Matrix<double, 7, 1>;  ///< q, qd … of an LBR [rad, rad/s …]
using Jacobian = Eigen::Matrix<double, 6, 7>;     ///< rows: v (3) then w (3)

struct JointLimit {
  double position_rad{0.0};                 ///< ± this
  double velocity_rad_per_s{0.0};
  double acceleration_rad_per_s2{0.0};
  double torque_Nm{0.0};
};

/// Geometry and limits of a KUKA LBR (spherical-revolute-spherical, no lateral offsets). Defaults: iiwa 14 R820.
/// Source: lbr_description; limits as in KUKA's data sheet; accelerations as Drake uses them.
struct LbrParams {
  double base_to_shoulder_m{0.360};
  double shoulder_to_elbow_m{0.420};
  double elbow_to_wrist_m{0.400};
  double wrist_to_flange_m{0.126};
  std::array<JointLimit, 7> limits{};
};

/// Kinematics of an LBR iiwa. Allocation-free.
class LbrArm {
 public:
  explicit LbrArm(const LbrParams& params) : params_(params) {}

  [[nodiscard]] const LbrParams& params() const { return params_; }

  /// X_BF of joint positions q [rad].
  [[nodiscard]] Pose FlangePose(const JointVector& q) const noexcept;

  /// Geometric Jacobian of the flange's origin, in B: V_BF = J qd, rows v then w.
  [[nodiscard]] Jacobian FlangeJacobian(const JointVector& q) const noexcept;

  /// Arm angle [rad]: of the shoulder-elbow-wrist plane about the shoulder-wrist line, 0 where q3 = 0 and the elbow is up.
  [[nodiscard]] double ArmAngle(const JointVector& q) const noexcept;

  /// Closed-form inverse: joint positions that put the flange at X_BF with the given arm angle, the nearest to `seed` (sum
  /// of squared joint differences) of the solutions within the position limits. False where there is none: out of reach
  /// or all beyond a limit; q is then unchanged.
  [[nodiscard]] bool Inverse(const Pose& X_BF, double arm_angle_rad, const JointVector& seed,
                             JointVector& q) const noexcept;

 private:
  LbrParams params_;
};

}  // namespace osteon::kinematics
