#pragma once

#include <limits>

#include "app/capability_task.h"
#include "kinematics/force_capability.h"
#include "kinematics/lbr_arm.h"
#include "kinematics/serial_chain.h"

namespace osteon::app {

/// What a posture, or the worst of several, can hold at the tool's apex [N]. Gravity's help is not counted
/// but in axial_exact_N: so the rest is what the servo loop's limiter lets through.
struct ToolForce {
  double axial_N{std::numeric_limits<double>::infinity()};  ///< along the tool, nothing else
  double lateral_N{
      std::numeric_limits<double>::infinity()};  ///< across it, in the weakest direction, nothing else
  double pressed_lateral_N{
      std::numeric_limits<double>::infinity()};  ///< the same while the needed axial force acts
  double axial_exact_N{
      std::numeric_limits<double>::infinity()};  ///< resisting along the tool, gravity counted
  /// Of the need, all of it at once: 1 or more where the arm can do what is asked.
  double factor{std::numeric_limits<double>::infinity()};
  int factor_joint{-1}, axial_joint{-1},
      lateral_joint{-1};  ///< 0 … 6: at its torque limit first; -1: the cap
  double joint_room_rad{
      std::numeric_limits<double>::infinity()};  ///< to the nearest position limit of the arm's own
  int room_joint{-1};

  /// The lesser of each.
  void Worsen(const ToolForce& other);
};

/// An arm with its payload and tool on a base that is fixed in the world.
class ArmForce {
 public:
  /// @throws std::invalid_argument where the arm is no LBR or has no masses or torque limits.
  /// @param arm  with sensor and tool as payload  @param R_WB  which way its base is turned
  ArmForce(const kinematics::ChainParams<7>& arm, const Matrix3& R_WB, const Pose& X_FT,
           const CapabilityNeed& need);

  /// Of joint positions q. @param base_turn_rad  the base stands turned by this about its own axis, from R_WB
  [[nodiscard]] ToolForce At(const kinematics::JointVector& q, double base_turn_rad = 0.0) const;
  /// At(q).factor alone, quicker.
  [[nodiscard]] double Factor(const kinematics::JointVector& q, double base_turn_rad = 0.0) const;
  /// Centres of elbow and wrist, in B.
  struct Places {
    Vector3 p_B_elbow, p_B_wrist;
  };
  [[nodiscard]] Places PlacesOf(const kinematics::JointVector& q) const;

 private:
  struct Held {
    kinematics::Jacobian J_T_B;
    kinematics::JointVector gravity_Nm;
    Vector3 axis_B;
  };
  [[nodiscard]] Held Hold(const kinematics::JointVector& q, double base_turn_rad) const;

  kinematics::SerialChain<7> chain_;
  kinematics::LbrParams lbr_;
  Pose X_FT_;
  CapabilityNeed need_;
  kinematics::JointVector torque_limit_Nm_;
};

}  // namespace osteon::app
