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

// Test bench of an arm that follows either the servo loop, or the same admittance law with another method of
// inverse kinematics, for comparison. A hand leads the tool along a path, or a scene supplies the wrench on
// the tool and the contact.

namespace osteon::studies {

/// The hand's goal for the tool, as a function of the time since the hand took hold.
struct HandGoal {
  Pose X_WT{Pose::Identity()};
  Twist V_WT{};  ///< velocity of the goal, in W
};
using HandPath = std::function<HandGoal(double time_s)>;

/// Computes the joint step [rad] for the desired twist of the tool, in B.
using StepMethod = std::function<kinematics::JointVector(
    const kinematics::Jacobian& J_tool, const kinematics::JointVector& q, const Twist& V_BT, double dt_s)>;

/// Arm, loop, hand and duration of a simulated run.
struct ArmTrialParams {
  kinematics::LbrParams arm;
  hil::ServoArmParams servo;
  control::ServoParams loop{};  ///< the bench sets limits and workspace; the spindle does not turn
  hil::OperatorHandParams hand;
  Pose X_FT{Pose::Identity()};
  kinematics::JointVector q_start{kinematics::JointVector::Zero()};
  double seconds{1.0};
  /// Time before the hand-over: the arm does not follow yet, the sensor reads, nothing is recorded.
  double waiting_s{0.0};
};

/// The arm's surroundings, evaluated once a millisecond. Ticks count from the hand-over of the arm; before it
/// they are negative.
struct ArmScene {
  /// The wrench on the tool, at its origin, in W. The tool's pose and velocity are the arm's true ones, not
  /// the commanded ones.
  std::function<Wrench(int tick, const Pose& X_WT, const Twist& V_WT)> hand;
  /// The newest contact model for the pose that was commanded last. Empty: no bone is near.
  std::function<simulation::ContactModel(int tick, rt::Nanoseconds now, const Pose& X_WT_cmd)> bone{};
  /// Converts the wrench that the sensor carries to its reading, both at the flange and in its frame. Empty:
  /// the reading is exact.
  std::function<Wrench(int tick, const Pose& X_WF, const Wrench& F_F)> sensor{};
};

/// The state of one millisecond.
struct ArmTrialTick {
  kinematics::JointVector q, qd;  ///< commanded [rad], [rad/s]
  Pose X_WT{Pose::Identity()};    ///< pose of the tool at the commanded joints
  HandGoal goal;
  Vector3 f_hand_N{Vector3::Zero()};  ///< force of the hand on the tool
  bool fault{false};
  Pose X_WT_meas{Pose::Identity()};       ///< the tool's true pose, which the hand feels
  Vector3 f_coupling_N{Vector3::Zero()};  ///< coupling force that the servo loop rendered
  double wrench_scale{1.0};               ///< factor by which the limits scaled this force
  double vibration_index{0.0};            ///< vibration index of the servo loop
  double vibration_reference_N{0.0};      ///< force reference of this vibration index
  double damping_factor{1.0};             ///< factor on the law's damping, set by the index
};

/// The iiwa 14 R820 (design: lengths of lbr_description, limits of KUKA's data sheet, accelerations as Drake
/// uses them).
[[nodiscard]] kinematics::LbrParams ScenarioArm();

/// Tool of the scenarios on its flange: straight, 0.2 m long.
[[nodiscard]] Pose ScenarioTool();

/// A trial with ScenarioArm and ScenarioTool that begins far from joint limits and singularities.
[[nodiscard]] ArmTrialParams ScenarioTrial();

/// The loop with the arm's joint limits, and with a workspace and a tracking error that do not restrict a
/// trial.
[[nodiscard]] control::ServoParams WithRoom(control::ServoParams loop, const kinematics::LbrParams& arm);

/// The arm of ScenarioArm with the masses of its links (centres of mass from config/robots; the inertias are
/// not used here).
[[nodiscard]] kinematics::ChainParams<7> ScenarioBody();

/// A contact model that consists of planes only, computed at `now`. @param frame  > 0
[[nodiscard]] simulation::ContactModel FreshModel(std::uint64_t frame, rt::Nanoseconds now,
                                                  std::span<const simulation::Contact> contacts = {});

/// Returns the reading of a sensor on the flange that carries this wrench.
[[nodiscard]] Wrench ReadBy(hil::SensorModel& sensor, int tick, const Wrench& F_F);

/// A plane that the tool's origin touches. @param n_W  unit, out of the bone
[[nodiscard]] simulation::Contact PlaneAt(const Vector3& p_W, const Vector3& n_W, double stiffness_N_per_m);

/// Simulates the arm with the shipped servo loop.
[[nodiscard]] std::vector<ArmTrialTick> RunLoopTrial(const ArmTrialParams& params, const HandPath& path);
/// Simulates the arm with the shipped servo loop in a given scene; the ticks' `goal` is empty.
[[nodiscard]] std::vector<ArmTrialTick> RunLoopTrial(const ArmTrialParams& params, const ArmScene& scene);

/// Simulates the same hand, arm and law, with the joint steps of another method.
[[nodiscard]] std::vector<ArmTrialTick> RunMethodTrial(const ArmTrialParams& params, const HandPath& path,
                                                       const StepMethod& method);

/// Largest joint speed of a tick as a share of that joint's limit.
[[nodiscard]] double JointSpeedShare(const kinematics::LbrParams& arm, const kinematics::JointVector& qd);

/// Largest change of the hand's force from one millisecond to the next [N].
[[nodiscard]] double LargestForceStep(const std::vector<ArmTrialTick>& trial);

}  // namespace osteon::studies
