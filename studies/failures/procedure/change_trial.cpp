#include "studies/failures/procedure/change_trial.h"

#include "control/laws/admittance_law.h"
#include "studies/failures/arm_bench.h"

namespace osteon::studies {
namespace {

constexpr double kMounting_m = 0.15;  // distance from the flange to the centre of a reamer's head
// Ticks of the phases before the change: waiting, rendering, pause.
constexpr int kWaiting = 50, kRenders = 500, kPause = 300;

}  // namespace

control::LoopTool ReamerOnFlange(double diameter_m, double mass_kg) {
  control::LoopTool tool;
  tool.X_FT.translation().z() = kMounting_m + 0.5 * diameter_m;
  tool.sensor.tool_mass_kg = mass_kg;
  tool.sensor.tool_center_F_m = Vector3(0.0, 0.0, 0.1);
  return tool;
}

ChangeTrial RunChangeTrial(const ChangeTrialParams& params) {
  const kinematics::LbrArm arm(ScenarioArm());
  kinematics::JointVector q_start;
  q_start << 0.1, 0.5, 0.05, -1.4, 0.1, 0.9, 0.2;
  const Pose& X_FT = params.tools.front().X_FT;
  const Pose X_start = arm.FlangePose(q_start) * X_FT;

  control::ServoParams servo;
  servo.joints.limits = arm.params().limits;
  servo.workspace.sphere_center_W_m = X_start.translation();
  servo.workspace.sphere_radius_m = 0.2;
  servo.workspace.plane_offset_m = X_start.translation().z() - 0.2;
  servo.spindle_rad_per_s = 0.0;
  servo.sensor = params.tools.front().sensor;
  control::ServoLoop loop(servo, arm, Pose::Identity(), X_FT, arm.ArmAngle(q_start));
  loop.SetTools(params.tools, 0);

  control::ArmState state;
  Eigen::Map<kinematics::JointVector>(state.q_meas.data()) = q_start;
  state.q_ipo = state.q_meas;
  state.has_ipo = true;
  state.session = control::SessionState::kCommandingWait;
  control::ArmCommand command;
  control::CellReadings readings;
  // mass on the simulated sensor
  double carried_kg = params.tools.front().sensor.tool_mass_kg;
  rt::Nanoseconds now = rt::kSecond;
  std::uint64_t frame = 0;
  control::TickRecord record;
  const auto tick = [&] {
    now += rt::kMillisecond;
    state.stamp = now;
    ++state.sequence;
    if (frame > 0) state.q_meas = command.q;
    if (state.session != control::SessionState::kCommandingActive) state.q_ipo = state.q_meas;
    const Pose X_WF = arm.FlangePose(Eigen::Map<const kinematics::JointVector>(state.q_meas.data()));
    control::ForceSensorParams load = params.tools.front().sensor;
    load.tool_mass_kg = carried_kg;
    readings.force = {.stamp = now, .F_S = control::ToolWeight(load, X_WF)};
    record = loop.Tick({.state = state,
                        .received = control::ReceiveResult::kOk,
                        .readings = readings,
                        .model = FreshModel(++frame, now),
                        .now = now},
                       command);
  };
  const auto run = [&](int count) {
    for (int i = 0; i < count; ++i) tick();
  };
  run(kWaiting);
  state.session = control::SessionState::kCommandingActive;
  run(kRenders);
  loop.RequestPause();
  run(kPause);

  ChangeTrial trial;
  trial.q_before = Eigen::Map<const kinematics::JointVector>(record.q_cmd.data());
  trial.X_before = record.X_WT_cmd;
  carried_kg += params.mounted_kg;
  if (params.changes_entry) loop.RequestTool(1);
  tick();
  trial.q_after = Eigen::Map<const kinematics::JointVector>(record.q_cmd.data());
  trial.X_after = record.X_WT_cmd;
  loop.RequestResume();
  const int after = static_cast<int>(params.seconds_after / 1e-3);
  for (int i = 0; i < after; ++i) {
    tick();
    trial.speed_mm_per_s.push_back(1e3 * Vector3(record.v_WT_cmd_m_per_s).norm());
  }
  trial.fault = loop.faults().Any();
  return trial;
}

}  // namespace osteon::studies
