#pragma once

#include <limits>

#include "kinematics/force_capability.h"
#include "kinematics/lbr_arm.h"
#include "kinematics/serial_chain.h"
#include "studies/capability/capability_task.h"

namespace osteon::studies {

/// The forces at the tool's apex that an arm can hold in one posture, or the smallest over several postures
/// [N]. Gravity's help counts only in axial_exact_N. In all other figures gravity only reduces the force, as
/// in the limiter of the servo loop.
struct ToolForce {
  /// Along the tool, no other load.
  double axial_N{std::numeric_limits<double>::infinity()};
  /// Across the tool, in the weakest direction, no other load.
  double lateral_N{std::numeric_limits<double>::infinity()};
  /// Across the tool while the needed axial force and torque act.
  double pressed_lateral_N{std::numeric_limits<double>::infinity()};
  /// Along the tool against the hand's push, with gravity's help, no other load.
  double axial_exact_N{std::numeric_limits<double>::infinity()};
  /// Fraction of the whole CapabilityNeed, applied at once, that the arm can hold; at least 1 if the arm is
  /// sufficient.
  double factor{std::numeric_limits<double>::infinity()};
  /// Number of the joint that reaches its torque limit first, 0 … 6; -1: none does, the force is at its cap.
  int factor_joint{-1}, axial_joint{-1}, lateral_joint{-1};
  /// Smallest distance of a joint from its position limits, and the number of this joint, 0 … 6.
  double joint_room_rad{std::numeric_limits<double>::infinity()};
  int room_joint{-1};

  /// Lowers each figure to that of `other`, together with its joint, if the figure of `other` is smaller.
  void LowerTo(const ToolForce& other);
};

/// The force capability of an arm with payload and tool, on a base that is fixed in the world.
class ArmForce {
 public:
  /// @throws std::invalid_argument if the arm is not an LBR or has no masses or torque limits.
  /// @param arm  with sensor and tool as payload  @param R_WB  orientation of its base
  ArmForce(const kinematics::ChainParams<7>& arm, const Matrix3& R_WB, const Pose& X_FT,
           const CapabilityNeed& need);

  /// Computes all figures at joint positions q. @param base_turn_rad  turn of the base about its own axis,
  /// from R_WB
  [[nodiscard]] ToolForce ForceAt(const kinematics::JointVector& q, double base_turn_rad = 0.0) const;
  /// Computes only ForceAt(q).factor, which is faster.
  [[nodiscard]] double NeedFactor(const kinematics::JointVector& q, double base_turn_rad = 0.0) const;
  /// The centres of elbow and wrist, in B.
  struct ElbowAndWrist {
    Vector3 p_B_elbow, p_B_wrist;
  };
  [[nodiscard]] ElbowAndWrist ElbowAndWristAt(const kinematics::JointVector& q) const;

 private:
  /// Jacobian, gravity torques and tool axis in one posture.
  struct Statics {
    kinematics::Jacobian J_T_B;
    kinematics::JointVector gravity_Nm;
    Vector3 axis_B;
  };
  [[nodiscard]] Statics ComputeStatics(const kinematics::JointVector& q, double base_turn_rad) const;

  kinematics::SerialChain<7> chain_;
  kinematics::LbrParams lbr_;
  Pose X_FT_;
  CapabilityNeed need_;
  kinematics::JointVector torque_limit_Nm_;
};

}  // namespace osteon::studies
