#include "studies/faults/fault_rig.h"

#include <stdexcept>
#include <string>

#include "studies/failures/arm_bench.h"

namespace osteon::studies {
namespace {

using control::ReceiveResult;
using control::SessionState;
using kinematics::JointVector;
using safety::CellState;

constexpr double kPeriod_s = 1e-3;
// Distance of the bone's plane ahead of the tool at the start, along the feed, and its stiffness.
constexpr double kPlaneAhead_m = 0.005, kPlaneStiffness_N_per_m = 20e3;
constexpr int kRenders = 300;   // ticks until the tool is in contact and moves along the plane
constexpr int kOnItsWay = 500;  // ticks after which the arm is about in the middle of the start path
constexpr int kMisses = 5;      // WatchdogParams::arm_misses

// The tool's pose X_WT at these joint positions.
Pose ToolAt(const JointVector& q) { return kinematics::LbrArm(ScenarioArm()).FlangePose(q) * ScenarioTool(); }

control::JointArray Array(const JointVector& q) {
  control::JointArray array{};
  Eigen::Map<JointVector>(array.data()) = q;
  return array;
}

}  // namespace

JointVector FaultRig::StartJoints() {
  JointVector q;
  q << 0.1, 0.5, 0.05, -1.4, 0.1, 0.9, 0.2;
  return q;
}

control::ServoParams FaultRig::Params(StartPath start_path) {
  control::ServoParams params;
  params.joints.limits = ScenarioArm().limits;
  params.workspace.sphere_center_W_m = ToolAt(StartJoints()).translation();
  params.workspace.sphere_radius_m = 0.6;
  params.workspace.plane_offset_m = -1.0;
  params.has_spindle = params.has_interlock = true;
  params.spindle_rad_per_s = 26.0;
  params.spindle_limits = {.max_torque_Nm = 5.0, .max_speed_rad_per_s = 60.0, .trip_s = 0.05};
  params.arm_body = ScenarioBody();
  // The rig's hand pushes all the time. So no bias is estimated, and the start path pauses only at a large
  // force.
  params.sensor_bias.acts = false;
  if (start_path == StartPath::kToStart) {
    JointVector goal = StartJoints();
    goal[0] += 0.3;
    params.start = control::StartParams{.q = goal, .path = {}, .pause_force_N = 200.0};
  }
  return params;
}

FaultRig::FaultRig(StartPath start_path, const JointVector& q)
    : kinematics_(ScenarioArm()),
      arm_(hil::ServoArmParams{}, ScenarioArm().limits, kPeriod_s, q),
      loop_(Params(start_path), kinematics_, Pose::Identity(), ScenarioTool(), kinematics_.ArmAngle(q)),
      q_told_(q),
      q_ipo_(q) {
  const Pose X_WT = ToolNow();
  feed_W_ = X_WT.linear().col(2);
  side_W_ = X_WT.linear().col(0);
  // with a start path the plane is far away, so that the tool touches nothing
  plane_W_ = X_WT.translation() + (start_path == StartPath::kNone ? kPlaneAhead_m : 5.0) * feed_W_;
}

Pose FaultRig::ToolNow() const { return kinematics_.FlangePose(arm_.q()) * ScenarioTool(); }

void FaultRig::HandOver() {
  session_ = SessionState::kCommandingActive;
  ++activation_;
  q_ipo_ = q_told_ = arm_.q();
}

// In every second tick: answers the previous tick's command by a frame whose contact is the plane.
void FaultRig::Simulate(rt::Nanoseconds now) {
  const simulation::ToolCommand command = loop_.tool_command();
  if (command.stamp == 0 || ticks_ % 2 != 0) return;
  const std::vector<simulation::Contact> plane{PlaneAt(plane_W_, Vector3(-feed_W_), kPlaneStiffness_N_per_m)};
  model_ = FreshModel(ticks_ + 1, now, plane);
  model_.pose_stamp = command.stamp;
}

RigInputs FaultRig::Inputs() {
  RigInputs in;
  in.now = time_ + clock_offset;
  in.arm.stamp = in.now;
  in.arm.sequence = ++sequence_;
  in.arm.session = session_;
  in.arm.quality = 3;
  in.arm.operation_mode = 2;
  in.arm.drives_active = true;
  in.arm.command_mode = control::CommandMode::kPosition;
  in.arm.q_meas = Array(arm_.q());
  in.arm.q_ipo = Array(session_ == SessionState::kCommandingActive ? q_ipo_ : arm_.q());
  in.arm.has_ipo = true;
  in.arm.activation = activation_;
  const Pose X_WT = ToolNow(), X_WF = X_WT * ScenarioTool().inverse();
  const Vector3 f_W = push_N * feed_W_ + side_N * side_W_;
  const Vector3 lever_W = X_WT.translation() - X_WF.translation();
  in.readings.force = {.stamp = in.now,
                       .F_S = Wrench{.f = X_WF.linear().transpose() * f_W,
                                     .t = X_WF.linear().transpose() * lever_W.cross(f_W)}};
  const bool turns = loop_.cell_commands().spindle_rad_per_s > 0.0;
  in.readings.spindle = {.stamp = in.now, .speed_rad_per_s = turns ? spindle_rad_per_s : 0.0, .ready = true};
  in.readings.interlock = {
      .stamp = in.now, .permitted = permitted, .enabled = permitted, .spindle_permitted = true};
  Simulate(in.now);
  in.model = model_;
  return in;
}

const control::TickRecord& FaultRig::Tick(const RigInjection& inject, int since) {
  time_ += kTick;
  RigInputs in = Inputs();
  if (inject) inject(in, since, *this);
  last_ = loop_.Tick(
      {.state = in.arm, .received = in.received, .readings = in.readings, .model = in.model, .now = in.now},
      command_);
  recorder_.Push(last_);
  if (recorder_.Stalled()) loop_.ReportRecorder();
  ++ticks_;
  // An arm that gets no answer holds the last command. An arm that is not handed over holds its position.
  if (in.received == ReceiveResult::kOk) {
    if (in.arm.session != SessionState::kCommandingActive)
      q_told_ = arm_.q();
    else if (command_.activation == activation_)
      q_told_ = Eigen::Map<const JointVector>(command_.q.data());
  }
  arm_.Step(q_told_);
  return last_;
}

void FaultRig::Run(int ticks) {
  for (int i = 0; i < ticks; ++i) Tick();
}

void FaultRig::BringTo(CellState state) {
  const RigInjection silent = [](RigInputs& in, int, FaultRig&) { in.received = ReceiveResult::kTimeout; };
  const auto render = [&] {
    Run(5);
    HandOver();
    Run(kRenders);
  };
  const auto lose_arm = [&] {
    for (int i = 0; i < kMisses; ++i) Tick(silent);
  };
  switch (state) {
    case CellState::kOff:
      break;
    case CellState::kChecking:
      permitted = false;
      Run(5);
      break;
    case CellState::kReady:
      Run(5);
      break;
    case CellState::kAligning:
      Run(5);
      HandOver();
      Run(kOnItsWay);
      break;
    case CellState::kHaptic:
      spindle_rad_per_s = 0.0;
      render();
      break;
    case CellState::kCutting:
      render();
      break;
    case CellState::kPaused:
      render();
      loop_.RequestPause();
      Run(200);
      break;
    case CellState::kStop0:
      render();
      lose_arm();
      break;
    case CellState::kStop1:
      render();
      loop_.RequestStop();
      Tick();
      break;
    case CellState::kStop2:
      render();
      loop_.RequestPause();
      Tick();
      break;
    case CellState::kFault:
      render();
      permitted = false;
      Run(200);
      permitted = true;
      break;
    case CellState::kRecovery:
      render();
      lose_arm();
      permitted = false;
      loop_.RequestRecovery();
      Tick();
      break;
  }
  if (loop_.state() != state)
    throw std::logic_error(std::string("led to ") + safety::Describe(loop_.state()).name + " instead of " +
                           safety::Describe(state).name);
}

}  // namespace osteon::studies
