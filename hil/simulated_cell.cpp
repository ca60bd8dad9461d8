#include "hil/simulated_cell.h"

#include <algorithm>
#include <utility>

namespace osteon::hil {
namespace {

using kinematics::JointVector;

JointVector ToVector(const control::JointArray& q) { return Eigen::Map<const JointVector>(q.data()); }

Wrench Turned(const Matrix3& R_AB, const Wrench& F_B) { return {.f = R_AB * F_B.f, .t = R_AB * F_B.t}; }

// Where the script begins: an arm that is brought there is let alone until then.
bool AtStart(const HandScript& script, const Pose& X_WT) {
  constexpr double kNear_m = 0.03, kNear_rad = 0.3;
  const Pose X_WT_start = script.Sample(0.0).X_WT;
  const Eigen::AngleAxisd turn(X_WT.linear().transpose() * X_WT_start.linear());
  return (X_WT.translation() - X_WT_start.translation()).norm() < kNear_m &&
         std::abs(turn.angle()) < kNear_rad;
}

// What the sensor between flange and tool carries of hand and weight.
Wrench SensorLoad(const control::ForceSensorParams& sensor, const Pose& X_WT, const Pose& X_WF,
                  const Wrench& F_hand_T_W) {
  const Pose X_WS = X_WF * Pose(sensor.X_FS);
  const Vector3 weight_W = sensor.tool_mass_kg * kinematics::kGravity_W_m_per_s2;
  const Vector3 lever_hand_W = X_WT.translation() - X_WS.translation();
  const Vector3 lever_weight_W = X_WF * Vector3(sensor.tool_center_F_m) - X_WS.translation();
  const Wrench F_S_W{.f = F_hand_T_W.f + weight_W,
                     .t = F_hand_T_W.t + lever_hand_W.cross(F_hand_T_W.f) + lever_weight_W.cross(weight_W)};
  return Turned(X_WS.linear().transpose(), F_S_W);
}

}  // namespace

SimulatedArmParams BodyOf(const SimulatedCellParams& params) {
  return {.level = params.level,
          .lbr = params.arm,
          .servo = params.servo,
          .dynamic = params.dynamic,
          .chain = params.chain,
          .gravity_B_m_per_s2 = Pose(params.X_WB).linear().transpose() * kinematics::kGravity_W_m_per_s2,
          .p_FT_m = Pose(params.X_FT).translation(),
          .q_start = ToVector(params.q_start)};
}

SimulatedCell::SimulatedCell(const SimulatedCellParams& params, HandScript script)
    : arm_(params.arm),
      X_WB_(params.X_WB),
      X_FT_(params.X_FT),
      X_TF_(X_FT_.inverse()),
      sensor_(params.sensor),
      server_(params.fri, params.arm.limits, ToVector(params.q_start)),
      body_(MakeSimulatedArm(BodyOf(params), server_.period_s())),
      hand_(params.hand, std::move(script)) {
  server_.Open();
}

void SimulatedCell::SetPower(bool on) {
  if (on == power_) return;
  power_ = on;
  if (on)
    server_.Acknowledge();
  else
    server_.EmergencyStop(0);
}

std::span<const std::uint8_t> SimulatedCell::Step(rt::Nanoseconds now, bool client_had_its_time) {
  // the client's answer, and the arm's move with it
  server_.EndCycle(client_had_its_time);
  const Matrix3 R_BT = (arm_.FlangePose(body_->q()) * X_FT_).linear();
  ArmDrive drive;
  drive.control = server_.control_mode();
  drive.q_cmd = server_.q_commanded();
  drive.tau_Nm = server_.tau_commanded();
  drive.F_T_B = Turned(R_BT, server_.F_commanded());
  body_->Step(drive, F_hand_T_B_);
  const bool active = server_.state() == control::SessionState::kCommandingActive;

  // the tool, as it is
  const Pose X_BT = arm_.FlangePose(body_->q()) * X_FT_;
  const Pose X_WT = X_WB_ * body_->X_BBnow() * X_BT;
  const Eigen::Matrix<double, 6, 1> V_BT = arm_.JacobianAt(body_->q(), X_FT_.translation()) * body_->qd();
  const Twist V_WT{.v = X_WB_.linear() * V_BT.head<3>(), .w = X_WB_.linear() * V_BT.tail<3>()};

  // the hand
  Wrench F_T_W;
  const bool holds = active && (holds_ || held_once_ || AtStart(hand_.script(), X_WT));
  if (holds && !holds_) {
    held_cycles_ = 0;
    held_once_ = true;
    hand_.Begin();
  }
  holds_ = holds;
  if (holds) {
    state_.cell_time_s = static_cast<double>(++held_cycles_) * period_s();
    F_T_W = hand_.Step(state_.cell_time_s, period_s(), X_WT, V_WT);
  }

  F_hand_T_B_ = Turned(X_WB_.linear().transpose(), F_T_W);

  const auto datagram = server_.BeginCycle({.q = body_->q(),
                                            .tau_meas = body_->tau_measured_Nm(),
                                            .tau_ext = body_->tau_external_Nm(),
                                            .X_BC = X_BT,
                                            .F_C_C = Turned(X_WT.linear().transpose(), F_T_W)},
                                           now);

  ++state_.cycle;
  state_.stamp = now;
  state_.session = server_.state();
  state_.active_once |= active;
  state_.script_done = state_.active_once && state_.cell_time_s >= hand_.script().duration_s();
  state_.counters = server_.counters();
  state_.stop = server_.stop();
  std::copy_n(body_->q().data(), control::kJoints, state_.q_meas.begin());
  std::copy_n(server_.q_commanded().data(), control::kJoints, state_.q_cmd.begin());
  state_.X_WT_meas = X_WT;
  state_.v_WT_meas_m_per_s = V_WT.v;
  state_.w_WT_meas_rad_per_s = V_WT.w;
  state_.F_hand_T_W = F_T_W;
  state_.F_S = SensorLoad(sensor_, X_WT, X_WT * X_TF_, F_T_W);
  return datagram;
}

}  // namespace osteon::hil
