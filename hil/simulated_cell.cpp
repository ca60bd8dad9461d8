#include "hil/simulated_cell.h"

#include <algorithm>
#include <utility>

namespace osteon::hil {
namespace {

using kinematics::JointVector;

JointVector ToVector(const control::JointArray& q) { return Eigen::Map<const JointVector>(q.data()); }

}  // namespace

SimulatedCell::SimulatedCell(const SimulatedCellParams& params, HandScript script)
    : arm_(params.arm),
      X_WB_(params.X_WB),
      X_FT_(params.X_FT),
      server_(params.fri, params.arm.limits, ToVector(params.q_start)),
      servo_(params.servo, params.arm.limits, server_.period_s(), ToVector(params.q_start)),
      hand_(params.hand, std::move(script)) {
  server_.Open();
}

std::span<const std::uint8_t> SimulatedCell::Step(rt::Nanoseconds now, bool client_had_its_time) {
  // the client's answer, and the arm's move with it
  const bool was_active = server_.state() == control::SessionState::kCommandingActive;
  server_.EndCycle(client_had_its_time);
  servo_.Step(server_.q_commanded());
  const bool active = server_.state() == control::SessionState::kCommandingActive;

  // the tool, as measured
  const Pose X_BF = arm_.FlangePose(servo_.q());
  const kinematics::Jacobian J = arm_.FlangeJacobian(servo_.q());
  const Eigen::Matrix<double, 6, 1> V_BF = J * servo_.qd();
  const Vector3 p_FT_B = X_BF.linear() * X_FT_.translation();
  const Twist V_WT{.v = X_WB_.linear() * (V_BF.head<3>() + V_BF.tail<3>().cross(p_FT_B)),
                   .w = X_WB_.linear() * V_BF.tail<3>()};
  const Pose X_WT = X_WB_ * X_BF * X_FT_;

  // the hand
  Wrench F_T_W;
  if (active && !was_active) {
    active_cycles_ = 0;
    hand_.Begin();
  }
  if (active) {
    state_.cell_time_s = static_cast<double>(++active_cycles_) * period_s();
    F_T_W = hand_.Step(state_.cell_time_s, period_s(), X_WT, V_WT);
  }

  // what the joints feel of it: tau = J^T F, F moved to the flange and expressed in B
  const Matrix3 R_BW = X_WB_.linear().transpose();
  Eigen::Matrix<double, 6, 1> F_F_B;
  F_F_B.head<3>() = R_BW * F_T_W.f;
  F_F_B.tail<3>() = R_BW * F_T_W.t + p_FT_B.cross(Vector3(F_F_B.head<3>()));

  const Matrix3 R_TW = X_WT.linear().transpose();
  const auto datagram = server_.BeginCycle({.q = servo_.q(),
                                            .tau_ext = J.transpose() * F_F_B,
                                            .X_BC = Pose(X_BF * X_FT_),
                                            .F_C_C = Wrench{.f = R_TW * F_T_W.f, .t = R_TW * F_T_W.t}},
                                           now);

  ++state_.cycle;
  state_.stamp = now;
  state_.session = server_.state();
  state_.active_once |= active;
  state_.script_done = state_.active_once && state_.cell_time_s >= hand_.script().duration_s();
  state_.counters = server_.counters();
  state_.stop = server_.stop();
  std::copy_n(servo_.q().data(), control::kJoints, state_.q_meas.begin());
  std::copy_n(server_.q_commanded().data(), control::kJoints, state_.q_cmd.begin());
  state_.X_WT_meas = X_WT;
  state_.v_WT_meas_m_per_s = V_WT.v;
  state_.w_WT_meas_rad_per_s = V_WT.w;
  state_.F_hand_T_W = F_T_W;
  return datagram;
}

}  // namespace osteon::hil
