#include "hil/failures/arm_bench.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace osteon::hil {
namespace {

using kinematics::JointVector;

constexpr double kDt_s = 1e-3;

// Arm and hand around whatever commands the joints. `command` gets the time, the measured joints and the
// hand's wrench.
struct Commanded {
  JointVector q;
  bool fault{false};
};
std::vector<ArmRideTick> Ride(
    const ArmRideParams& params, const HandPath& path,
    const std::function<Commanded(int tick, const JointVector& q_meas, const Wrench& F_T_W)>& command) {
  const kinematics::LbrArm arm(params.arm);
  ServoArm servo(params.servo, params.arm.limits, kDt_s, params.q_start);
  HandImpedance hand(params.hand);  // at the tool's origin
  JointVector q_before = params.q_start;
  std::vector<ArmRideTick> ride;
  const int ticks = static_cast<int>(std::lround(params.seconds / kDt_s));
  ride.reserve(static_cast<std::size_t>(ticks));
  for (int i = 0; i < ticks; ++i) {
    ArmRideTick tick;
    tick.goal = path(i * kDt_s);
    const Eigen::Matrix<double, 6, 1> V = arm.JacobianAt(servo.q(), params.X_FT.translation()) * servo.qd();
    const Wrench F =
        safety::ScaleWrench(hand.Step(kDt_s, arm.FlangePose(servo.q()) * params.X_FT,
                                      {.v = V.head<3>(), .w = V.tail<3>()}, tick.goal.X_WT, tick.goal.V_WT),
                            params.hand.max_force_N, params.hand.max_torque_Nm)
            .F;
    const Commanded commanded = command(i, servo.q(), F);
    servo.Step(commanded.q);
    tick.q = commanded.q;
    tick.qd = (commanded.q - q_before) / kDt_s;
    tick.X_WT = arm.FlangePose(commanded.q) * params.X_FT;
    tick.f_hand_N = F.f;
    tick.fault = commanded.fault;
    q_before = commanded.q;
    ride.push_back(tick);
  }
  return ride;
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

std::vector<ArmRideTick> RideServoLoop(const ArmRideParams& params, const HandPath& path) {
  const kinematics::LbrArm arm(params.arm);
  control::ServoParams servo;
  servo.joints.limits = params.arm.limits;
  servo.workspace.sphere_radius_m = 3.0;
  servo.workspace.plane_offset_m = -3.0;
  servo.spindle_rad_per_s = 0.0;
  servo.max_tracking_error_m = 0.1;
  control::ServoLoop loop(servo, arm, Pose::Identity(), params.X_FT, arm.ArmAngle(params.q_start));
  control::ArmCommand command;
  return Ride(params, path, [&](int i, const JointVector& q_meas, const Wrench& F_T_W) -> Commanded {
    const rt::Nanoseconds now = rt::kSecond + i * rt::kMillisecond;
    control::ArmState state;
    state.stamp = now;
    state.session = control::SessionState::kCommandingActive;
    state.period_s = kDt_s;
    state.has_ipo = true;
    Eigen::Map<JointVector>(state.q_meas.data()) = q_meas;
    Eigen::Map<JointVector>(state.q_ipo.data()) = q_meas;
    simulation::ContactModel nothing_near;
    nothing_near.frame = static_cast<std::uint64_t>(i + 1);
    nothing_near.pose_stamp = now;
    // as a sensor without mounting and tool reads it: at the flange, in its frame
    const Pose X_WF = arm.FlangePose(q_meas);
    const Vector3 lever_W = X_WF.linear() * params.X_FT.translation();
    const Wrench F_S{.f = X_WF.linear().transpose() * F_T_W.f,
                     .t = X_WF.linear().transpose() * (F_T_W.t + lever_W.cross(F_T_W.f))};
    const control::CellReadings readings{.force = {.stamp = now, .F_S = F_S}, .spindle = {}, .interlock = {}};
    const control::TickRecord record =
        loop.Tick(state, control::ReceiveResult::kOk, readings, nothing_near, now, command);
    return {.q = Eigen::Map<const JointVector>(command.q.data()), .fault = record.faults != 0};
  });
}

std::vector<ArmRideTick> RideMethod(const ArmRideParams& params, const HandPath& path,
                                    const StepMethod& method) {
  const kinematics::LbrArm arm(params.arm);
  const control::ServoParams same;  // law and speed limits
  JointVector q = params.q_start;
  Twist V;
  return Ride(params, path, [&](int, const JointVector&, const Wrench& F_T_W) -> Commanded {
    // the virtual tool is where the joints are, as in the loop
    Twist V_next;
    if (!control::NextTwist(same.admittance, arm.FlangePose(q) * params.X_FT, V, F_T_W, kDt_s, V_next))
      return {.q = q, .fault = true};
    V = safety::LimitTwist(V_next, same.twist).V;
    const JointVector step = method(arm.JacobianAt(q, params.X_FT.translation()), q, V, kDt_s);
    if (!step.allFinite()) return {.q = q, .fault = true};
    q += step;
    return {.q = q};
  });
}

double JointSpeedShare(const kinematics::LbrParams& arm, const JointVector& qd) {
  double share = 0.0;
  for (std::size_t i = 0; i < 7; ++i)
    share = std::max(share, std::abs(qd[static_cast<Eigen::Index>(i)]) / arm.limits[i].velocity_rad_per_s);
  return share;
}

double LargestForceStep(const std::vector<ArmRideTick>& ride) {
  double largest = 0.0;
  for (std::size_t i = 1; i < ride.size(); ++i)
    largest = std::max(largest, (ride[i].f_hand_N - ride[i - 1].f_hand_N).norm());
  return largest;
}

}  // namespace osteon::hil
