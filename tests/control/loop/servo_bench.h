#pragma once

#include <vector>

#include "control/loop/servo_loop.h"
#include "tests/kinematics/iiwa14.h"

namespace osteon::control {

/// A servo loop in virtual time with three simulated partners: an arm that follows its command one tick
/// later, a simulation of bone with one plane ahead of the tool, and a hand that pushes with a given force.
class ServoBench {
 public:
  static constexpr rt::Nanoseconds kTick = rt::kMillisecond;

  static kinematics::JointVector StartJoints() {
    kinematics::JointVector q;
    q << 0.1, 0.5, 0.05, -1.4, 0.1, 0.9, 0.2;
    return q;
  }
  static Pose FlangeToTool() {
    Pose X_FT = Pose::Identity();
    X_FT.translation() << 0.0, 0.0, 0.20;
    return X_FT;
  }
  static kinematics::LbrArm Arm() { return kinematics::LbrArm(kinematics::Iiwa14()); }
  static Pose StartPose() { return Arm().FlangePose(StartJoints()) * FlangeToTool(); }
  /// Parameters with a workspace of 0.2 m around the start pose, and the spindle off.
  static ServoParams Params() {
    ServoParams params;
    params.joints.limits = Arm().params().limits;
    params.workspace.sphere_center_W_m = StartPose().translation();
    params.workspace.sphere_radius_m = 0.2;
    params.workspace.plane_offset_m = StartPose().translation().z() - 0.2;
    params.spindle_rad_per_s = 0.0;
    return params;
  }

  /// @param plane_ahead_m  distance along the feed from the apex at the start to the bone's plane
  explicit ServoBench(const ServoParams& params = Params(), double plane_ahead_m = 0.005)
      : loop(params, Arm(), Pose::Identity(), FlangeToTool(), Arm().ArmAngle(StartJoints())) {
    Eigen::Map<kinematics::JointVector>(arm.q_meas.data()) = StartJoints();
    arm.q_ipo = arm.q_meas;
    arm.has_ipo = true;
    arm.session = SessionState::kCommandingWait;
    feed_W = StartPose().linear().col(2);
    plane_W = StartPose().translation() + plane_ahead_m * feed_W;
  }

  /// Runs one tick. The arm's joints follow the command of the previous tick.
  TickRecord Tick(ReceiveResult received = ReceiveResult::kOk) {
    now += kTick;
    if (received == ReceiveResult::kOk) {
      arm.stamp = now;
      ++arm.sequence;
      if (answered_ && arm_moves) arm.q_meas = command.q;
      answered_ = true;
      if (arm.session != SessionState::kCommandingActive) arm.q_ipo = arm.q_meas;
    }
    if (sensor_lives) {
      readings.force = {
          .stamp = now,
          .F_S = OnTheSensor({.f = push_N * feed_W + side_W_N, .t = Vector3::Zero()}, ToolNow())};
    }
    if (simulation_lives && ticks % frame_ticks == 0) Simulate();
    const TickRecord record = loop.Tick(
        {.state = arm, .received = received, .readings = readings, .model = model, .now = now}, command);
    ++ticks;
    last_command = loop.tool_command();
    return record;
  }

  /// Runs this number of ticks. @returns the record of the last tick
  TickRecord Run(int count) {
    TickRecord record;
    for (int i = 0; i < count; ++i) record = Tick();
    return record;
  }

  /// Pose of the tool, computed from the arm's joints.
  [[nodiscard]] Pose ToolNow() const {
    return arm_.FlangePose(Eigen::Map<const kinematics::JointVector>(arm.q_meas.data())) * FlangeToTool();
  }

  /// The reading of a force sensor at the flange, in the flange's frame, if this wrench acts on the tool.
  static Wrench OnTheSensor(const Wrench& F_T_W, const Pose& X_WT) {
    const Pose X_WF = X_WT * FlangeToTool().inverse();
    const Vector3 lever_W = X_WT.translation() - X_WF.translation();
    return {.f = X_WF.linear().transpose() * F_T_W.f,
            .t = X_WF.linear().transpose() * (F_T_W.t + lever_W.cross(F_T_W.f))};
  }

  /// The arm's controller begins to follow the loop's commands.
  void Activate() { arm.session = SessionState::kCommandingActive; }

  /// Depth of the commanded apex behind the bone's plane [m]; negative: in front of it.
  [[nodiscard]] double Depth() const {
    return feed_W.dot(Pose(loop.tool_command().X_WT).translation() - plane_W);
  }

  ServoLoop loop;
  ArmState arm;
  ArmCommand command;
  CellReadings readings;
  simulation::ContactModel model;
  simulation::ToolCommand last_command;
  rt::Nanoseconds now{rt::kSecond};
  int ticks{0}, frame_ticks{2};  ///< number of ticks so far; number of ticks for one frame of the simulation
  double push_N{0.0};            ///< force of the hand along the feed; side_W_N acts in addition
  Vector3 side_W_N{Vector3::Zero()};
  /// false: no new reading of the sensor, no new frame of the simulation
  bool sensor_lives{true}, simulation_lives{true};
  double reach_m{10.0};          ///< largest distance to the tool at which a frame contains the plane
  bool arm_moves{true};          ///< false: the arm stays in place in spite of commands
  bool one_frame_behind{false};  ///< true: a frame is delivered only when the next frame begins
  Vector3 feed_W, plane_W;

 private:
  kinematics::LbrArm arm_{Arm()};
  bool answered_{false};

  // Computes the frame for the command of the previous tick.
  void Simulate() {
    simulation::ContactModel frame;
    frame.frame = static_cast<std::uint64_t>(ticks + 1);
    frame.pose_stamp = ticks > 0 ? last_command.stamp : now;
    const double gap_m = feed_W.dot(plane_W - Vector3(last_command.X_WT.p));
    frame.contact_count = gap_m <= reach_m ? 1 : 0;
    frame.contacts[0].p_W_m = plane_W;
    frame.contacts[0].n_W = Vector3(-feed_W);
    frame.contacts[0].stiffness_N_per_m = 20e3;
    model = one_frame_behind ? in_work_ : frame;
    in_work_ = frame;
  }

  simulation::ContactModel in_work_;  // latest frame; with one_frame_behind, it is not yet delivered
};

}  // namespace osteon::control
