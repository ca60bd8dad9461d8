#pragma once

#include <array>
#include <cstdint>

#include "base/marker.h"
#include "kinematics/chain_params.h"
#include "kinematics/lbr_params.h"
#include "kinematics/serial_chain.h"
#include "kinematics/spatial.h"

namespace osteon::kinematics {

using JointVector = JointVectorN<7>;  ///< q, qd … of an LBR [rad, rad/s …]
using Jacobian = JacobianN<7>;        ///< rows: v (3) then w (3)

/// One posture that reaches a pose.
struct LbrSolution {
  JointVector q{JointVector::Zero()};  ///< [rad], each within -pi … pi
  double beyond_rad{0.0};              ///< how far the worst joint is outside its limits; 0 if all are within
  int worst_joint{-1};                 ///< 0 … 6, the joint with beyond_rad; -1 if all are within
  std::uint8_t beyond{0};              ///< bit i: joint i is outside its limits

  [[nodiscard]] bool valid() const noexcept { return beyond == 0; }
};

/// All postures for a pose and an arm angle: one for each configuration, or none.
struct LbrSolutions {
  static constexpr int kConfigurations = 8;

  /// Index: configuration number (LbrArm::Configuration). Set only if reachable().
  std::array<LbrSolution, kConfigurations> configuration;
  /// How far the wrist's centre is out of the reach of the arm's two links: > 0 too far from the shoulder, <
  /// 0 too near, 0 reachable, NaN if the pose or the angle is not finite.
  double out_of_reach_m{0.0};

  [[nodiscard]] bool reachable() const noexcept { return out_of_reach_m == 0.0; }

  /// The valid solution nearest to `seed` (by the sum of squared joint differences; on a tie the lower
  /// number); nullptr if there is none or the seed is not finite.
  [[nodiscard]] const LbrSolution* Nearest(const JointVector& seed) const OSTEON_RT;
};

/// Kinematics of an LBR iiwa. Allocation-free.
///
/// Joints A1 … A7 turn about z, y, z, -y, z, y, z; at zero the arm is stretched upwards (LbrParams has the
/// product). A1 A2 A3 meet in the shoulder, A4 is the elbow, A5 A6 A7 meet in the wrist. With shoulder and
/// wrist in place, the elbow can still move on a circle about the line between them. The arm angle is the
/// elbow's position on this circle.
class LbrArm {
 public:
  static constexpr int kJoints = 7;
  using Joints = JointVectorN<7>;

  /// @throws std::invalid_argument naming the length or the limit that is out of range (LbrParams).
  explicit LbrArm(const LbrParams& params);

  [[nodiscard]] const LbrParams& params() const noexcept { return params_; }

  /// X_BF of joint positions q [rad].
  [[nodiscard]] Pose FlangePose(const JointVector& q) const OSTEON_RT;

  /// Geometric Jacobian of a point of the flange, in B: V = J qd, rows v then w.
  /// @param p_F  the point in the flange's frame, such as the origin of a tool
  [[nodiscard]] Jacobian JacobianAt(const JointVector& q, const Vector3& p_F) const OSTEON_RT;

  /// Configuration number 0 … 7: bit 0 is set if q2 < 0, bit 1 if q4 < 0, bit 2 if q6 < 0.
  [[nodiscard]] static int Configuration(const JointVector& q) OSTEON_RT {
    return (q[1] < 0.0 ? 1 : 0) + (q[3] < 0.0 ? 2 : 0) + (q[5] < 0.0 ? 4 : 0);
  }

  /// The flange's pose, and the centre of the elbow in B [m]: the point where the axis of A4 crosses the
  /// upper arm's axis.
  struct ArmPoints {
    Pose X_BF;
    Vector3 p_BElbow;
  };
  [[nodiscard]] ArmPoints Points(const JointVector& q) const OSTEON_RT {
    const SerialChain<7>::Posture posture = chain_.ComputePosture(q);
    return {.X_BF = posture.X_BF, .p_BElbow = posture.p_BL[3]};
  }

  /// Arm angle [rad], -pi … pi: the elbow's position on its circle, as the right-handed angle about the line
  /// from shoulder to wrist, from the circle's highest point. It is 0 if q3 = 0 and the elbow is up, pi if
  /// the elbow points down. If the line is vertical the angle starts at +x of B. It is computed from the axis
  /// of A4, so it stays defined and exact for a straight arm (q4 = 0 is treated as q4 > 0).
  [[nodiscard]] double ArmAngle(const JointVector& q) const OSTEON_RT;

  /// Closed-form inverse: every posture that puts the flange at X_BF with the given arm angle.
  ///
  /// When a bent joint is flipped and its neighbours turn by pi, every link stays in place, so the eight
  /// postures share one set of seven arctangents. Sines and cosines come from vector components, never from
  /// an angle, and each joint is computed relative to the axes of the joints before it. Therefore the pose is
  /// exact to rounding even near a singularity; only the distribution of a rotation over two joints is
  /// uncertain there.
  /// @param seed value of a joint that a singularity leaves free (A1 with the upper arm vertical, A5 with the
  ///   wrist straight): two configurations then coincide; in one of them the joint has this value, in the
  ///   other it is half a turn away.
  ///
  /// Source: Shimizu et al., Analytical Inverse Kinematic Computation for 7-DOF Redundant Manipulators With
  /// Joint Limits, IEEE Trans. Robotics 24 (5), 2008; here the angle is measured from the vertical instead of
  /// from the arm with q3 = 0, so that the angle alone fixes the elbow's position for all signs of q2 and q4.
  [[nodiscard]] LbrSolutions Solve(const Pose& X_BF, double arm_angle_rad,
                                   const JointVector& seed = JointVector::Zero()) const OSTEON_RT;

  /// Writes Solve(X_BF, arm_angle_rad, seed).Nearest(seed) into q. Returns false, with q unchanged, if there
  /// is no solution: the pose is out of reach, all solutions are beyond a limit, or an input is not finite.
  /// `q` may be the same object as `seed`.
  [[nodiscard]] bool Inverse(const Pose& X_BF, double arm_angle_rad, const JointVector& seed,
                             JointVector& q) const OSTEON_RT;

 private:
  LbrParams params_;
  SerialChain<7> chain_;
};

}  // namespace osteon::kinematics
