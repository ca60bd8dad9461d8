#include "hil/fri_arm.h"

#include <algorithm>

namespace osteon::hil {
namespace {

control::JointArray ToArray(const kinematics::JointVector& q) {
  control::JointArray array{};
  std::copy_n(q.data(), control::kJoints, array.begin());
  return array;
}

}  // namespace

FriArm::FriArm(const FriServerParams& fri, const SimulatedArmParams& body, const Pose& X_FT)
    : arm_(body.lbr),
      X_FT_(X_FT),
      server_(fri, body.lbr.limits, body.q_start),
      body_(MakeSimulatedArm(body, server_.period_s())) {
  server_.Open();
}

void FriArm::Move(bool client_had_its_time, const Wrench& F_T_B) {
  server_.EndCycle(client_had_its_time);
  // If no client has answered yet, the operator at the pad would start the program again.
  if (server_.stop().reason == StopReason::kQualityTimeout && server_.counters().answered == 0) {
    server_.Open();
    if (!power_) server_.PowerOff();
  }
  const Matrix3 R_BT = (arm_.FlangePose(body_->q()) * X_FT_).linear();
  ArmDrive drive;
  drive.control = server_.control_mode();
  drive.q_cmd = server_.q_commanded();
  drive.tau_Nm = server_.tau_commanded();
  drive.F_T_B = ExpressedIn(R_BT, server_.F_commanded());
  body_->Step(drive, F_T_B);
}

std::span<const std::uint8_t> FriArm::Message(const Wrench& F_T_T, rt::Nanoseconds now) {
  return server_.BeginCycle({.q = body_->q(),
                             .tau_meas = body_->tau_measured_Nm(),
                             .tau_ext = body_->tau_external_Nm(),
                             .X_BC = arm_.FlangePose(body_->q()) * X_FT_,
                             .F_C_C = F_T_T},
                            now);
}

void FriArm::SetPower(bool on) {
  if (on == power_) return;
  power_ = on;
  if (on)
    server_.Acknowledge();
  else
    server_.PowerOff();
}

bool FriArm::EndSession() {
  constexpr double kUntilIdle_s = 0.05;  // time in MONITORING_READY before IDLE; a public log shows 0.083 s
  if (server_.session_end() == SessionEnd::kSilence || server_.state() == control::SessionState::kIdle)
    return false;
  server_.CloseAfter(kUntilIdle_s);
  return true;
}

ArmMotion FriArm::motion() const {
  const Eigen::Matrix<double, 6, 1> V_BT = arm_.JacobianAt(body_->q(), X_FT_.translation()) * body_->qd();
  return {.q_meas = ToArray(body_->q()),
          .q_cmd = ToArray(server_.q_commanded()),
          .X_BT = arm_.FlangePose(body_->q()) * X_FT_,
          .V_BT = {.v = V_BT.head<3>(), .w = V_BT.tail<3>()},
          .X_BBnow = body_->X_BBnow()};
}

ArmStatus FriArm::status() const {
  ArmStatus status;
  status.session = server_.state();
  status.counters = server_.counters();
  status.stop = server_.stop();
  return status;
}

}  // namespace osteon::hil
