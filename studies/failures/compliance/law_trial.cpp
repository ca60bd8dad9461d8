#include "studies/failures/compliance/law_trial.h"

#include <cmath>
#include <memory>
#include <numbers>

#include "hil/arm/sensor_load.h"
#include "hil/arm/simulated_arm.h"
#include "hil/operator/hand_grid.h"
#include "kinematics/lbr_arm.h"
#include "kinematics/payload.h"
#include "studies/failures/arm_bench.h"

namespace osteon::studies {
namespace {

using control::Law;
using kinematics::JointVector;

constexpr double kPeriod_s = 1e-3;

// Joint angles [rad] at which every run starts.
JointVector Start() { return ScenarioTrial().q_start; }

// The scenarios' arm with a tool of 2 kg on its flange.
kinematics::ChainParams<7> LoadedArm() {
  return kinematics::WithPayload(
      ScenarioBody(),
      {.mass_kg = 2.0, .p_LLcm_m = {0.0, 0.0, 0.08}, .I_LLcm_kg_m2 = 0.004 * Matrix3::Identity()});
}

// The arm that a law commands: for the admittance law an arm that follows positions, for the impedance law an
// arm with masses and a soft impedance controller of its own.
std::unique_ptr<hil::SimulatedArm> ArmOf(Law law) {
  hil::SimulatedArmParams params{.lbr = ScenarioArm(), .chain = LoadedArm(), .q_start = Start()};
  params.p_FT_m = ScenarioTool().translation();
  if (law == Law::kImpedance) {
    params.level = hil::ArmLevel::kDynamic;
    params.dynamic.stiffness_N_per_m = 500.0;  // a soft arm, so that the hand holds the tool
    params.dynamic.stiffness_Nm_per_rad_turn = 50.0;
  }
  return hil::MakeSimulatedArm(params, kPeriod_s);
}

}  // namespace

control::ServoParams LoopOfLaw(Law law, double stiffness_N_per_m) {
  control::ServoParams loop;
  loop.law = law;
  loop.coupling.max_stiffness_N_per_m = stiffness_N_per_m;
  loop.coupling.damping_Ns_per_m = 200.0;
  if (law == Law::kAdmittance) return loop;
  loop.impedance.damping_Ns_per_m.setConstant(40.0);
  loop.impedance.damping_Nms_per_rad.setConstant(1.0);
  loop.arm_body = LoadedArm();
  return loop;
}

Pose StartOfLawTrial() { return kinematics::LbrArm(ScenarioArm()).FlangePose(Start()) * ScenarioTool(); }

Pose BoneOfLawTrial() { return StartOfLawTrial() * Eigen::AngleAxisd(std::numbers::pi, Vector3::UnitX()); }

PushingHand::PushingHand()
    : hand_(hil::OperatorWith(
          {.name = "stiff", .stiffness_N_per_m = 3000.0, .damping_Ns_per_m = 60.0, .mass_kg = 3.0})),
      X_start_(StartOfLawTrial()) {}

Wrench PushingHand::Step(double push_N, const Pose& X_WT, const Twist& V_WT) {
  const Vector3 feed_W = X_start_.linear().col(2);
  // Set to the tool's depth below, so that the hand's spring does not act along the feed.
  Pose X_goal = X_start_;
  X_goal.translation() += feed_W.dot(X_WT.translation() - X_start_.translation()) * feed_W;
  Wrench F_T_W = hand_.Step(kPeriod_s, X_WT, V_WT, X_goal, {});
  F_T_W.f += push_N * feed_W;
  return F_T_W;
}

safety::FaultSet RunLawTrial(const LawTrialParams& params, const LawScene& scene) {
  const kinematics::LbrParams lbr = ScenarioArm();
  const kinematics::LbrArm arm(lbr);
  const bool is_position = params.loop.law == Law::kAdmittance;
  const control::ServoParams servo = WithRoom(params.loop, lbr);
  control::ServoLoop loop(servo, arm, Pose::Identity(), ScenarioTool(), arm.ArmAngle(Start()));
  const std::unique_ptr<hil::SimulatedArm> simulated = ArmOf(servo.law);
  control::ArmState state;
  state.session = control::SessionState::kCommandingActive;
  state.command_mode = is_position ? control::CommandMode::kPosition : control::CommandMode::kWrench;
  state.activation = 1;
  state.period_s = kPeriod_s;
  state.has_ipo = true;
  hil::ArmDrive drive{.q_cmd = Start()};
  if (!is_position) drive.control = control::ControlMode::kCartesianImpedance;
  control::ArmCommand command;
  rt::Nanoseconds now = rt::kSecond;
  for (int i = 0; i < static_cast<int>(std::lround(params.seconds / kPeriod_s)); ++i) {
    now += rt::kMillisecond;
    const JointVector q = simulated->q();
    const Pose X_WF = arm.FlangePose(q), X_WT = X_WF * ScenarioTool();
    const Eigen::Matrix<double, 6, 1> V = arm.JacobianAt(q, ScenarioTool().translation()) * simulated->qd();
    const Wrench F_T_W = scene.hand(i, X_WT, {.v = V.head<3>(), .w = V.tail<3>()});
    state.stamp = now;
    ++state.sequence;
    Eigen::Map<JointVector>(state.q_meas.data()) = q;
    Eigen::Map<JointVector>(state.q_ipo.data()) = drive.q_cmd;
    simulation::ToolCommand followed = loop.tool_command();
    if (i == 0) followed.X_WT = X_WT;
    simulation::ContactModel model = scene.bone(followed);
    model.pose_stamp = i == 0 ? now : followed.stamp;
    const control::CellReadings readings{
        .force = {.stamp = now, .F_S = hil::SensorLoad({}, X_WT, X_WF, F_T_W)},
        .spindle = {},
        .interlock = {}};
    const control::TickRecord record = loop.Tick({.state = state,
                                                  .received = control::ReceiveResult::kOk,
                                                  .readings = readings,
                                                  .model = model,
                                                  .now = now},
                                                 command);
    drive.q_cmd = Eigen::Map<const JointVector>(command.q.data());
    if (!is_position)
      drive.F_T_B = {.f = X_WT.linear() * Vector3(command.F.f), .t = X_WT.linear() * Vector3(command.F.t)};
    simulated->Step(drive, is_position ? Wrench{} : F_T_W);
    if (scene.seen && !scene.seen(i, {.X_WT = X_WT,
                                      .X_ME = loop.tool_command().X_WT,
                                      .X_WT_sim = is_position ? Pose(record.X_WT_cmd) : X_WT,
                                      .f_coupling_N = Vector3(record.F_coupling_T_W.f),
                                      .renders = safety::Renders(loop.state())}))
      break;
  }
  return loop.faults();
}

}  // namespace osteon::studies
