#pragma once

#include <array>

#include "base/marker.h"
#include "kinematics/chain_params.h"

namespace osteon::safety {

/// Forward kinematics of a seven-axis arm, only for the guard. It shares no code with the controller's
/// kinematics (kinematics::SerialChain, kinematics::LbrArm), so that an error there is detected; both use
/// only the same arm description and Eigen.
///
/// The method is a product of exponentials. At q = 0, joint i turns about the line through o_i along the unit
/// vector a_i, both in W. The position of a point that joint i moves is its position at q = 0, rotated by the
/// joints i, i-1 … 1, in this order:
///
///     p(q) = T_1(q_1) … T_i(q_i) p(0)     T(q) p = o + v cos q + (a × v) sin q + a (a·v) (1 - cos q)
///                                         v = p - o   (Rodrigues)
///
/// Source: Lynch and Park, Modern Robotics, 2017, section 4.1 (space form).
class GuardKinematics {
 public:
  static constexpr std::size_t kJoints = 7;
  using Joints = kinematics::JointVectorN<7>;

  /// @param X_WB robot base in world  @param X_FT tool on the flange
  /// @throws std::invalid_argument naming what was found and what is accepted.
  GuardKinematics(const kinematics::ChainParams<7>& chain, const Pose& X_WB, const Pose& X_FT);

  /// Positions in W of the points that the guard checks [m], and the tool's orientation.
  struct Placement {
    Vector3 p_WT;       ///< the tool's apex
    Vector3 p_WFlange;  ///< the centre of the flange
    Vector3 p_WElbow;   ///< the centre of the elbow: the point of the axis of A4 nearest to the axis of A3
    Matrix3 R_WT;
  };
  [[nodiscard]] Placement ComputePlacement(const Joints& q) const OSTEON_RT;

  /// Velocities, in W, for 1 rad/s of each joint: linear, of a point that moves with the flange, and angular,
  /// of the flange.
  struct JointMotions {
    std::array<Vector3, kJoints> v;  ///< velocity of the point per rad/s [m]
    std::array<Vector3, kJoints> w;  ///< the joint's axis, unit
  };
  /// Computes the velocities at q. @param p_WP  position of the point at q
  [[nodiscard]] JointMotions ComputeJointMotions(const Joints& q, const Vector3& p_WP) const OSTEON_RT;

 private:
  struct Turn {  // cosine and sine of one joint's position
    double cosine, sine;
  };
  using Turns = std::array<Turn, kJoints>;
  static Turns ComputeTurns(const Joints& q) OSTEON_RT;
  // Rotates a direction, or a point, by the first `count` joints.
  [[nodiscard]] Vector3 TurnDirection(const Turns& turns, std::size_t count, Vector3 v_W) const OSTEON_RT;
  [[nodiscard]] Vector3 TurnPoint(const Turns& turns, std::size_t count, Vector3 p_W) const OSTEON_RT;

  // joint axes and points on them, at q = 0, in W
  std::array<Vector3, kJoints> axis_W_, origin_W_;
  Vector3 p_WT_, p_WFlange_, p_WElbow_;
  Matrix3 R_WT_;
};

}  // namespace osteon::safety
