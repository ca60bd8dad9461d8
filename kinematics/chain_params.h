#pragma once

#include <array>
#include <numbers>

#include "kinematics/spatial.h"

// Parameters of a serial arm of revolute joints: the content of a robot description file, in SI.
//
// Frames: link frame i has its origin on the axis of joint i and turns with the joint; link 0 is the fixed
// base B. At joint position q
//
//     X_(i-1)i = X_PJ_i  Rot(axis_J_i, q_i)        X_BF = X_01 X_12 ... X_(N-1)N X_LF

namespace osteon::kinematics {

template <int N>
using JointVectorN = Eigen::Matrix<double, N, 1>;  ///< q, qd, qdd, tau [rad, rad/s, rad/s^2, N·m]
template <int N>
using JacobianN = Eigen::Matrix<double, 6, N>;  ///< rows: v (3) then w (3)
template <int N>
using JointMatrixN = Eigen::Matrix<double, N, N>;

/// Acceleration of free fall in the world, whose z points up.
inline const Vector3 kGravity_W_m_per_s2{0.0, 0.0, -9.81};

/// Limits of one joint. Positions have a lower and an upper bound, because the range of a KR's joints is not
/// symmetric about zero.
struct JointLimits {
  double lower_rad{-std::numbers::pi};
  double upper_rad{std::numbers::pi};
  double velocity_rad_per_s{0.0};
  double acceleration_rad_per_s2{0.0};
  double torque_Nm{0.0};  ///< 0: the maker publishes no value
};

/// Mass properties of a rigid body.
struct LinkInertia {
  double mass_kg{0.0};
  Vector3 p_LLcm_m{Vector3::Zero()};      ///< centre of mass, in the link's frame
  Matrix3 I_LLcm_kg_m2{Matrix3::Zero()};  ///< about the centre of mass, along the link frame's axes
};

/// Friction of a joint's drive, as a torque at the joint (not at the motor):
///
///     tau = viscous qd + coulomb tanh(qd / smoothing)
struct JointFriction {
  double viscous_Nms_per_rad{0.0};
  double coulomb_Nm{0.0};
  double smoothing_rad_per_s{0.01};  ///< > 0
};

/// A joint and the link that it moves.
struct RevoluteJoint {
  Pose X_PJ{Pose::Identity()};       ///< link frame at q = 0, in the frame of the previous link
  Vector3 axis_J{Vector3::UnitZ()};  ///< unit
  JointLimits limits;
  LinkInertia link;
  JointFriction friction;
  /// Inertia of the drive's rotor, as it acts at the joint: the rotor's own inertia times the gear ratio
  /// squared.
  double rotor_inertia_kg_m2{0.0};
};

/// @tparam N number of joints, 6 or 7
template <int N>
struct ChainParams {
  std::array<RevoluteJoint, static_cast<std::size_t>(N)> joints;
  Pose X_LF{Pose::Identity()};  ///< flange in the last link's frame
  bool has_masses{false};       ///< false: kinematics and limits only, the dynamics must not be called
};

}  // namespace osteon::kinematics
