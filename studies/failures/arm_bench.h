#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "control/loop/servo_loop.h"
#include "hil/arm/servo_arm.h"
#include "hil/can/sensor_model.h"
#include "hil/operator/operator_hand.h"
#include "kinematics/lbr_arm.h"
#include "kinematics/lbr_params.h"

// Test bench of an arm that follows either the servo loop, or the same law with another method of inverse
// kinematics to compare. A hand leads the tool along a path, or a scene supplies the wrench on the tool and
// the contact.

namespace osteon::studies {

/// The hand's goal for the tool, by the time since the hand took hold.
struct HandGoal {
  Pose X_WT{Pose::Identity()};
  Twist V_WT{};  ///< of the goal, in W
};
using HandPath = std::function<HandGoal(double time_s)>;

/// Turns the desired twist of the tool, in B, into a joint step [rad].
using StepMethod = std::function<kinematics::JointVector(
    const kinematics::Jacobian& J_tool, const kinematics::JointVector& q, const Twist& V_BT, double dt_s)>;

/// Arm, loop and hand of a ride, and its length.
struct ArmRideParams {
  kinematics::LbrParams arm;
  hil::ServoArmParams servo;
  control::ServoParams loop{};  ///< the ride sets limits and workspace; the spindle stands still
  hil::OperatorHandParams hand;
  Pose X_FT{Pose::Identity()};
  kinematics::JointVector q_start{kinematics::JointVector::Zero()};
  double seconds{1.0};
  /// Time before the ride: the arm is not handed over yet, the sensor reads, nothing is recorded.
  double waiting_s{0.0};
};

/// The arm's surroundings, evaluated once a millisecond. Ticks count from the hand-over; below 0 the arm
/// waits.
struct ArmScene {
  /// The wrench on the tool, at its origin, in W. The tool's pose and velocity are the arm's true ones, not
  /// the commanded ones.
  std::function<Wrench(int tick, const Pose& X_WT, const Twist& V_WT)> hand;
  /// The newest contact model, for the pose commanded last. Empty: nothing is near.
  std::function<simulation::ContactModel(int tick, rt::Nanoseconds now, const Pose& X_WT_cmd)> bone{};
  /// The sensor's reading of the wrench that it carries (at the flange, in its frame). Empty: the same
  /// wrench.
  std::function<Wrench(int tick, const Pose& X_WF, const Wrench& F_F)> sensor{};
};

/// The state of one millisecond.
struct ArmRideTick {
  kinematics::JointVector q, qd;  ///< commanded [rad], [rad/s]
  Pose X_WT{Pose::Identity()};    ///< of the commanded joints
  HandGoal goal;
  Vector3 f_hand_N{Vector3::Zero()};  ///< force of the hand on the tool
  bool fault{false};
  Pose X_WT_meas{Pose::Identity()};       ///< the tool's true pose, which the hand feels
  Vector3 f_coupling_N{Vector3::Zero()};  ///< rendered by the servo loop
  double wrench_scale{1.0};               ///< the limits' factor on this force
  double vibration_index{0.0};            ///< of the servo loop
  double vibration_reference_N{0.0};      ///< of the same index
  double damping_factor{1.0};             ///< factor on the law's damping, set by the index
};

/// The iiwa 14 R820 (design: lengths of lbr_description, limits of KUKA's data sheet, accelerations as Drake
/// uses them).
[[nodiscard]] kinematics::LbrParams ScenarioArm();

/// Tool of the scenarios on its flange: straight, 0.2 m long.
[[nodiscard]] Pose ScenarioTool();

/// The same arm with the masses of its links (centres from config/robots; inertias are not used here).
[[nodiscard]] kinematics::ChainParams<7> ScenarioBody();

/// A contact model of planes alone, fresh at `now`. @param frame  > 0
[[nodiscard]] simulation::ContactModel FreshModel(std::uint64_t frame, rt::Nanoseconds now,
                                                  std::span<const simulation::Contact> contacts = {});

/// The reading of a sensor on the flange for this wrench.
[[nodiscard]] Wrench ReadBy(hil::SensorModel& sensor, int tick, const Wrench& F_F);

/// A plane that the tool's origin touches. @param n_W  unit, out of the bone
[[nodiscard]] simulation::Contact PlaneAt(const Vector3& p_W, const Vector3& n_W, double stiffness_N_per_m);

/// Rides with the real servo loop.
[[nodiscard]] std::vector<ArmRideTick> RideServoLoop(const ArmRideParams& params, const HandPath& path);
/// Rides with the real servo loop in a given scene; the ticks' `goal` is empty.
[[nodiscard]] std::vector<ArmRideTick> RideServoLoop(const ArmRideParams& params, const ArmScene& scene);

/// Rides with the same hand, arm and law, but joint steps by the method.
[[nodiscard]] std::vector<ArmRideTick> RideMethod(const ArmRideParams& params, const HandPath& path,
                                                  const StepMethod& method);

/// Largest joint speed of a tick as a share of that joint's limit.
[[nodiscard]] double JointSpeedShare(const kinematics::LbrParams& arm, const kinematics::JointVector& qd);

/// Largest change of the hand's force in a millisecond [N].
[[nodiscard]] double LargestForceStep(const std::vector<ArmRideTick>& ride);

}  // namespace osteon::studies
