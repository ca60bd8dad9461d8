#include "studies/capability/arm_force.h"

#include <algorithm>

namespace osteon::studies {
namespace {

using kinematics::CapabilityLimit;
using kinematics::ForceCapability;
using kinematics::GravityHelp;
using kinematics::JointVector;

// Replaces `value` and `tag` by the other value and its tag if the other value is smaller.
template <typename Tag>
void KeepLesser(double& value, Tag& tag, double other, Tag other_tag) {
  if (!(other < value)) return;
  value = other;
  tag = other_tag;
}

}  // namespace

void ToolForce::LowerTo(const ToolForce& other) {
  KeepLesser(axial_N, axial_joint, other.axial_N, other.axial_joint);
  KeepLesser(lateral_N, lateral_joint, other.lateral_N, other.lateral_joint);
  KeepLesser(factor, factor_joint, other.factor, other.factor_joint);
  KeepLesser(joint_room_rad, room_joint, other.joint_room_rad, other.room_joint);
  pressed_lateral_N = std::min(pressed_lateral_N, other.pressed_lateral_N);
  axial_exact_N = std::min(axial_exact_N, other.axial_exact_N);
}

ArmForce::ArmForce(const kinematics::ChainParams<7>& arm, const Matrix3& R_WB, const Pose& X_FT,
                   const CapabilityNeed& need)
    : chain_(arm, R_WB.transpose() * kinematics::kGravity_W_m_per_s2),
      lbr_(kinematics::LbrParamsFrom(arm)),
      X_FT_(X_FT),
      need_(need) {
  for (int i = 0; i < 7; ++i) torque_limit_Nm_[i] = arm.joints[static_cast<std::size_t>(i)].limits.torque_Nm;
}

// Computes the statics of a base that is turned about A1's axis. Such a turn changes the gravity torques in
// the same way as a turn of A1 by the same angle.
ArmForce::Statics ArmForce::ComputeStatics(const JointVector& q, double base_turn_rad) const {
  JointVector q_hanging = q;
  q_hanging[0] += base_turn_rad;
  const auto posture = chain_.ComputePosture(q);
  const Pose X_BT = posture.X_BF * X_FT_;
  return {.J_T_B = chain_.JacobianAt(posture, X_BT.translation()),
          .gravity_Nm = chain_.Gravity(q_hanging),
          .axis_B = X_BT.linear().col(2)};
}

double ArmForce::NeedFactor(const JointVector& q, double base_turn_rad) const {
  const Statics statics = ComputeStatics(q, base_turn_rad);
  return ForceCapability<7>(statics.J_T_B, statics.gravity_Nm, torque_limit_Nm_, GravityHelp::kNotCounted)
      .Factor(statics.axis_B,
              {.axial_N = need_.axial_N, .lateral_N = need_.lateral_N, .torque_Nm = need_.torque_Nm})
      .value;
}

ToolForce ArmForce::ForceAt(const JointVector& q, double base_turn_rad) const {
  const Statics statics = ComputeStatics(q, base_turn_rad);
  const ForceCapability<7> cautious(statics.J_T_B, statics.gravity_Nm, torque_limit_Nm_,
                                    GravityHelp::kNotCounted);
  const ForceCapability<7> exact(statics.J_T_B, statics.gravity_Nm, torque_limit_Nm_, GravityHelp::kCounted);
  const CapabilityLimit axial = cautious.Force(statics.axis_B),
                        lateral = cautious.LateralForce(statics.axis_B);
  const CapabilityLimit factor = cautious.Factor(
      statics.axis_B, {.axial_N = need_.axial_N, .lateral_N = need_.lateral_N, .torque_Nm = need_.torque_Nm});
  ToolForce force{
      .axial_N = axial.value,
      .lateral_N = lateral.value,
      .pressed_lateral_N = cautious.LateralForce(statics.axis_B, need_.axial_N, need_.torque_Nm).value,
      // With gravity's help: the arm resists the hand as bone resists the tool, by a force that points away
      // from the bone.
      .axial_exact_N = exact.Force(-statics.axis_B).value,
      .factor = factor.value,
      .factor_joint = factor.joint,
      .axial_joint = axial.joint,
      .lateral_joint = lateral.joint};
  for (int i = 0; i < 7; ++i) {
    const kinematics::JointLimits& limits = chain_.params().joints[static_cast<std::size_t>(i)].limits;
    KeepLesser(force.joint_room_rad, force.room_joint,
               std::min(q[i] - limits.lower_rad, limits.upper_rad - q[i]), i);
  }
  return force;
}

ArmForce::ElbowAndWrist ArmForce::ElbowAndWristAt(const JointVector& q) const {
  // Start at the wrist and go back to the elbow: an arm's file may place a joint's origin anywhere along the
  // joint's axis.
  const auto posture = chain_.ComputePosture(q);
  const Vector3 p_B_wrist = posture.X_BF * Vector3(0.0, 0.0, -lbr_.wrist_to_flange_m);
  return {.p_B_elbow = p_B_wrist - lbr_.elbow_to_wrist_m * posture.axis_B(4), .p_B_wrist = p_B_wrist};
}

}  // namespace osteon::studies
