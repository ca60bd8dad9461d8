#include "studies/failures/arm_bench.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hil/arm/sensor_load.h"

namespace osteon::studies {
namespace {

using kinematics::JointVector;

constexpr double kDt_s = 1e-3;
// Time at which the arm is handed over; above 0, since the ticks before it need time stamps, too.
constexpr rt::Nanoseconds kHandOver = 10 * rt::kSecond;

// Computes the commanded joints of a tick. It receives the tick (negative: the arm waits), the measured
// joints and the wrench on the tool, and fills in its part of the tick's record.
using Commander =
    std::function<JointVector(int tick, const JointVector& q_meas, const Wrench& F_T_W, ArmTrialTick&)>;

// Simulates the arm in the scene, commanded by `command`. @returns the ticks from the hand-over of the arm on
std::vector<ArmTrialTick> RunTrial(const ArmTrialParams& params, const ArmScene& scene,
                                   const Commander& command) {
  const kinematics::LbrArm arm(params.arm);
  hil::ServoArm servo(params.servo, params.arm.limits, kDt_s, params.q_start);
  JointVector q_before = params.q_start;
  std::vector<ArmTrialTick> trial;
  const int ticks = static_cast<int>(std::lround(params.seconds / kDt_s));
  trial.reserve(static_cast<std::size_t>(ticks));
  for (int i = -static_cast<int>(std::lround(params.waiting_s / kDt_s)); i < ticks; ++i) {
    ArmTrialTick tick;
    const Eigen::Matrix<double, 6, 1> V = arm.JacobianAt(servo.q(), params.X_FT.translation()) * servo.qd();
    tick.X_WT_meas = arm.FlangePose(servo.q()) * params.X_FT;
    const Wrench F = scene.hand(i, tick.X_WT_meas, {.v = V.head<3>(), .w = V.tail<3>()});
    const JointVector q = command(i, servo.q(), F, tick);
    servo.Step(q);
    tick.q = q;
    tick.qd = (q - q_before) / kDt_s;
    tick.X_WT = arm.FlangePose(q) * params.X_FT;
    tick.f_hand_N = F.f;
    q_before = q;
    if (i >= 0) trial.push_back(tick);
  }
  return trial;
}

// The scene of a hand that leads the tool's origin along a path.
ArmScene SceneOf(const hil::OperatorHandParams& params, const HandPath& path) {
  return {.hand = [params, path, hand = hil::HandImpedance(params)](int tick, const Pose& X_WT,
                                                                    const Twist& V_WT) mutable {
    const HandGoal goal = path(tick * kDt_s);
    return safety::ScaleWrench(hand.Step(kDt_s, X_WT, V_WT, goal.X_WT, goal.V_WT), params.max_force_N,
                               params.max_torque_Nm)
        .F;
  }};
}

// Returns the same run with the path's goal entered in every tick.
std::vector<ArmTrialTick> WithGoals(std::vector<ArmTrialTick> trial, const HandPath& path) {
  for (std::size_t i = 0; i < trial.size(); ++i) trial[i].goal = path(static_cast<double>(i) * kDt_s);
  return trial;
}

}  // namespace

kinematics::LbrParams ScenarioArm() {
  constexpr double deg = std::numbers::pi / 180.0;
  return {.base_to_shoulder_m = 0.360,
          .shoulder_to_elbow_m = 0.420,
          .elbow_to_wrist_m = 0.400,
          .wrist_to_flange_m = 0.126,
          .limits = {kinematics::JointLimits{-170 * deg, 170 * deg, 85 * deg, 8.57, 320.0},
                     {-120 * deg, 120 * deg, 85 * deg, 8.57, 320.0},
                     {-170 * deg, 170 * deg, 100 * deg, 8.74, 176.0},
                     {-120 * deg, 120 * deg, 75 * deg, 11.36, 176.0},
                     {-170 * deg, 170 * deg, 130 * deg, 12.23, 110.0},
                     {-120 * deg, 120 * deg, 135 * deg, 15.72, 40.0},
                     {-175 * deg, 175 * deg, 135 * deg, 15.72, 40.0}}};
}

Pose ScenarioTool() {
  Pose X_FT = Pose::Identity();
  X_FT.translation() = Vector3(0.0, 0.0, 0.20);
  return X_FT;
}

kinematics::ChainParams<7> ScenarioBody() {
  kinematics::ChainParams<7> body = kinematics::ChainFrom(ScenarioArm());
  constexpr std::array<double, 7> kMass_kg{5.290, 5.689, 3.461, 4.123, 1.564, 2.458, 0.265};
  const std::array<Vector3, 7> centers_m{
      Vector3(0, -0.034, 0.280), {0, 0.038, 0.076}, {0, 0.035, 0.351}, {0, -0.029, 0.087},
      {0, -0.030, 0.284},        {0, 0, 0.005},     {0, 0, 0.105}};
  for (std::size_t i = 0; i < 7; ++i)
    body.joints[i].link = {.mass_kg = kMass_kg[i],
                           .p_LLcm_m = centers_m[i],
                           .I_LLcm_kg_m2 = 1e-3 * kMass_kg[i] * Matrix3::Identity()};
  body.has_masses = true;
  return body;
}

ArmTrialParams ScenarioTrial() {
  ArmTrialParams params;
  params.arm = ScenarioArm();
  params.X_FT = ScenarioTool();
  params.q_start << 0.2, 0.5, 0.1, -1.4, 0.15, 0.8, 0.3;
  return params;
}

control::ServoParams WithRoom(control::ServoParams loop, const kinematics::LbrParams& arm) {
  loop.joints.limits = arm.limits;
  loop.workspace.sphere_radius_m = 3.0;
  loop.workspace.plane_offset_m = -3.0;
  loop.max_tracking_error_m = 0.1;
  return loop;
}

simulation::ContactModel FreshModel(std::uint64_t frame, rt::Nanoseconds now,
                                    std::span<const simulation::Contact> contacts) {
  simulation::ContactModel model;
  model.frame = frame;
  model.pose_stamp = now;
  model.contact_count = static_cast<std::int32_t>(contacts.size());
  std::ranges::copy(contacts, model.contacts.begin());
  return model;
}

Wrench ReadBy(hil::SensorModel& sensor, int tick, const Wrench& F_F) {
  const hil::SensorModel::Sample read = sensor.Read(kHandOver + tick * rt::kMillisecond, F_F);
  return {.f = {read.value[0], read.value[1], read.value[2]},
          .t = {read.value[3], read.value[4], read.value[5]}};
}

simulation::Contact PlaneAt(const Vector3& p_W, const Vector3& n_W, double stiffness_N_per_m) {
  simulation::Contact plane;
  plane.p_W_m = p_W;
  plane.n_W = n_W;
  plane.stiffness_N_per_m = stiffness_N_per_m;
  return plane;
}

std::vector<ArmTrialTick> RunLoopTrial(const ArmTrialParams& params, const ArmScene& scene) {
  const kinematics::LbrArm arm(params.arm);
  control::ServoParams servo = WithRoom(params.loop, params.arm);
  servo.spindle_rad_per_s = 0.0;
  control::ServoLoop loop(servo, arm, Pose::Identity(), params.X_FT, arm.ArmAngle(params.q_start));
  control::ArmCommand command;
  Pose X_WT_cmd = arm.FlangePose(params.q_start) * params.X_FT;
  std::uint64_t frame = 0;
  return RunTrial(
      params, scene,
      [&](int i, const JointVector& q_meas, const Wrench& F_T_W, ArmTrialTick& tick) -> JointVector {
        const rt::Nanoseconds now = kHandOver + i * rt::kMillisecond;
        control::ArmState state;
        state.stamp = now;
        state.session =
            i < 0 ? control::SessionState::kCommandingWait : control::SessionState::kCommandingActive;
        state.period_s = kDt_s;
        state.has_ipo = true;
        Eigen::Map<JointVector>(state.q_meas.data()) = q_meas;
        Eigen::Map<JointVector>(state.q_ipo.data()) = q_meas;
        const simulation::ContactModel model =
            scene.bone ? scene.bone(i, now, X_WT_cmd) : FreshModel(++frame, now);
        // reading of a sensor at the flange, in the flange's frame, without the tool's weight
        const Pose X_WF = arm.FlangePose(q_meas);
        Wrench F_S = hil::SensorLoad({}, X_WF * params.X_FT, X_WF, F_T_W);
        if (scene.sensor) F_S = scene.sensor(i, X_WF, F_S);
        const control::CellReadings readings{
            .force = {.stamp = now, .F_S = F_S}, .spindle = {}, .interlock = {}};
        const control::TickRecord record = loop.Tick({.state = state,
                                                      .received = control::ReceiveResult::kOk,
                                                      .readings = readings,
                                                      .model = model,
                                                      .now = now},
                                                     command);
        tick.fault = record.faults != 0;
        tick.f_coupling_N = Vector3(record.F_coupling_T_W.f);
        tick.wrench_scale = record.wrench_scale;
        tick.vibration_index = record.vibration_index;
        tick.vibration_reference_N = record.vibration_reference_N;
        tick.damping_factor = record.damping_factor;
        const JointVector q = Eigen::Map<const JointVector>(command.q.data());
        X_WT_cmd = arm.FlangePose(q) * params.X_FT;
        return q;
      });
}

std::vector<ArmTrialTick> RunLoopTrial(const ArmTrialParams& params, const HandPath& path) {
  return WithGoals(RunLoopTrial(params, SceneOf(params.hand, path)), path);
}

std::vector<ArmTrialTick> RunMethodTrial(const ArmTrialParams& params, const HandPath& path,
                                         const StepMethod& method) {
  const kinematics::LbrArm arm(params.arm);
  // the parameters that the servo loop has by default, for the law and the speed limits
  const control::ServoParams defaults;
  JointVector q = params.q_start;
  Twist V;
  const auto step = [&](int, const JointVector&, const Wrench& F_T_W, ArmTrialTick& tick) -> JointVector {
    // the virtual tool is reset to the pose of the commanded joints, as the servo loop does
    Twist V_next;
    tick.fault = !control::NextTwist(
        defaults.admittance,
        {.X_WT = arm.FlangePose(q) * params.X_FT, .V_WT = V, .F_T_W = F_T_W, .dt_s = kDt_s}, V_next);
    if (tick.fault) return q;
    V = safety::LimitTwist(V_next, defaults.twist).V;
    const JointVector q_step = method(arm.JacobianAt(q, params.X_FT.translation()), q, V, kDt_s);
    tick.fault = !q_step.allFinite();
    if (!tick.fault) q += q_step;
    return q;
  };
  return WithGoals(RunTrial(params, SceneOf(params.hand, path), step), path);
}

double JointSpeedShare(const kinematics::LbrParams& arm, const JointVector& qd) {
  double share = 0.0;
  for (std::size_t i = 0; i < 7; ++i)
    share = std::max(share, std::abs(qd[static_cast<Eigen::Index>(i)]) / arm.limits[i].velocity_rad_per_s);
  return share;
}

double LargestForceStep(const std::vector<ArmTrialTick>& trial) {
  double largest = 0.0;
  for (std::size_t i = 1; i < trial.size(); ++i)
    largest = std::max(largest, (trial[i].f_hand_N - trial[i - 1].f_hand_N).norm());
  return largest;
}

}  // namespace osteon::studies
