#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "control/servo_loop.h"
#include "hil/can/sensor_model.h"
#include "hil/operator_hand.h"
#include "hil/servo_arm.h"
#include "kinematics/lbr_arm.h"
#include "kinematics/lbr_params.h"

// An arm that follows the servo loop, or the same law with the inverse kinematics that is to be compared with
// it; a hand that leads the tool along a path, or whatever else exerts something on it, and what it touches.

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
  control::ServoParams loop{};  ///< limits and workspace are the ride's, and its spindle stands
  OperatorHandParams hand;
  Pose X_FT{Pose::Identity()};
  kinematics::JointVector q_start{kinematics::JointVector::Zero()};
  double seconds{1.0};
  double waiting_s{
      0.0};  ///< before it: the arm is not handed over yet, the sensor reads, nothing is recorded
};

/// What is around the arm, once a millisecond. Ticks count from the hand-over; below 0 the arm waits.
struct ArmScene {
  /// What is exerted on the tool, at its origin, in W. The tool's pose and velocity are the arm's, not the
  /// command's.
  std::function<Wrench(int tick, const Pose& X_WT, const Twist& V_WT)> hand;
  /// The newest contact model, from the pose that was commanded last. Empty: nothing is near.
  std::function<simulation::ContactModel(int tick, rt::Nanoseconds now, const Pose& X_WT_cmd)> bone{};
  /// What the sensor makes of the wrench that it carries (at the flange, in its frame). Empty: the same.
  std::function<Wrench(int tick, const Pose& X_WF, const Wrench& F_F)> sensor{};
};

/// One millisecond.
struct ArmRideTick {
  kinematics::JointVector q, qd;  ///< commanded [rad], [rad/s]
  Pose X_WT{Pose::Identity()};    ///< of the commanded joints
  HandGoal goal;
  Vector3 f_hand_N{Vector3::Zero()};  ///< what the hand exerts
  bool fault{false};
  Pose X_WT_meas{Pose::Identity()};       ///< where the arm has the tool: what the hand feels
  Vector3 f_coupling_N{Vector3::Zero()};  ///< of the servo loop: rendered
  double wrench_scale{1.0};               ///< of it that the limits let through
  double vibration_index{0.0};            ///< of the servo loop
  double vibration_reference_N{0.0};      ///< of it,
  double damping_factor{1.0};             ///< and what it makes of the law
};

/// The iiwa 14 R820 (design: lengths of lbr_description, limits of KUKA's data sheet, accelerations as Drake
/// uses them).
[[nodiscard]] kinematics::LbrParams ScenarioArm();

/// Tool of the scenarios on its flange: straight, .2 m long.
[[nodiscard]] Pose ScenarioTool();

/// That arm with the masses of its links (centres from config/robots; of inertia nothing here asks).
[[nodiscard]] kinematics::ChainParams<7> ScenarioBody();

/// A model of planes alone, fresh at `now`. @param frame  > 0
[[nodiscard]] simulation::ContactModel FreshModel(std::uint64_t frame, rt::Nanoseconds now,
                                                  std::span<const simulation::Contact> contacts = {});

/// The wrench as a sensor on the flange makes a reading of it.
[[nodiscard]] Wrench ReadBy(SensorModel& sensor, int tick, const Wrench& F_F);

/// A plane that the tool's origin touches. @param n_W  unit, out of the bone
[[nodiscard]] simulation::Contact PlaneAt(const Vector3& p_W, const Vector3& n_W, double stiffness_N_per_m);

/// The real servo loop.
[[nodiscard]] std::vector<ArmRideTick> RideServoLoop(const ArmRideParams& params, const HandPath& path);
/// The same in a scene of its own; `goal` of its ticks is empty.
[[nodiscard]] std::vector<ArmRideTick> RideServoLoop(const ArmRideParams& params, const ArmScene& scene);

/// The same hand, arm and law; joint steps by the method.
[[nodiscard]] std::vector<ArmRideTick> RideMethod(const ArmRideParams& params, const HandPath& path,
                                                  const StepMethod& method);

/// Largest joint speed of a tick as a share of that joint's limit.
[[nodiscard]] double JointSpeedShare(const kinematics::LbrParams& arm, const kinematics::JointVector& qd);

/// Largest change of the hand's force in a millisecond [N].
[[nodiscard]] double LargestForceStep(const std::vector<ArmRideTick>& ride);

}  // namespace osteon::hil
