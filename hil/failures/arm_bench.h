#pragma once

#include <functional>
#include <vector>

#include "control/servo_loop.h"
#include "hil/operator_hand.h"
#include "hil/servo_arm.h"
#include "kinematics/lbr_arm.h"
#include "kinematics/lbr_params.h"

// A hand that leads the tool along a path, nothing to touch, and an arm that follows: with the servo loop, or
// with the same law and the inverse kinematics that is to be compared with it.

namespace osteon::hil {

/// Where the hand wants the tool, by the time since it took hold.
struct HandGoal {
  Pose X_WT{Pose::Identity()};
  Twist V_WT{};  ///< of the goal, in W
};
using HandPath = std::function<HandGoal(double time_s)>;

/// Turns the wanted twist of the tool, in B, into a joint step [rad].
using StepMethod = std::function<kinematics::JointVector(
    const kinematics::Jacobian& J_tool, const kinematics::JointVector& q, const Twist& V_BT, double dt_s)>;

struct ArmRideParams {
  kinematics::LbrParams arm;
  ServoArmParams servo;
  OperatorHandParams hand;
  Pose X_FT{Pose::Identity()};
  kinematics::JointVector q_start{kinematics::JointVector::Zero()};
  double seconds{1.0};
};

/// One millisecond.
struct ArmRideTick {
  kinematics::JointVector q, qd;  ///< commanded [rad], [rad/s]
  Pose X_WT{Pose::Identity()};    ///< of the commanded joints
  HandGoal goal;
  Vector3 f_hand_N{Vector3::Zero()};  ///< what the hand exerts
  bool fault{false};
};

/// The iiwa 14 R820 (design: lengths of lbr_description, limits of KUKA's data sheet, accelerations as Drake
/// uses them).
[[nodiscard]] kinematics::LbrParams ScenarioArm();

/// Tool of the scenarios on its flange: straight, .2 m long.
[[nodiscard]] Pose ScenarioTool();

/// The real servo loop.
[[nodiscard]] std::vector<ArmRideTick> RideServoLoop(const ArmRideParams& params, const HandPath& path);

/// The same hand, arm and law; joint steps by the method.
[[nodiscard]] std::vector<ArmRideTick> RideMethod(const ArmRideParams& params, const HandPath& path,
                                                  const StepMethod& method);

/// Largest joint speed of a tick as a share of that joint's limit.
[[nodiscard]] double JointSpeedShare(const kinematics::LbrParams& arm, const kinematics::JointVector& qd);

/// Largest change of the hand's force in a millisecond [N].
[[nodiscard]] double LargestForceStep(const std::vector<ArmRideTick>& ride);

}  // namespace osteon::hil
