#include "hil/simulated_cell.h"

#include <utility>

#include "hil/arm/sensor_load.h"

namespace osteon::hil {
namespace {

using kinematics::JointVector;

JointVector ToVector(const control::JointArray& q) { return Eigen::Map<const JointVector>(q.data()); }

// Makes a KR connected by RSI if the parameters contain one, otherwise an LBR connected by FRI.
std::unique_ptr<ArmController> MakeArm(const SimulatedCellParams& params) {
  if (params.kr) return std::make_unique<RsiArm>(*params.kr, params.q_start, Pose(params.X_FT));
  return std::make_unique<FriArm>(params.fri, BodyOf(params), Pose(params.X_FT));
}

// Whether the distance and the angle between two poses are both below these bounds.
bool IsNear(const Pose& X_WT, const Pose& X_WT_start, double distance_m, double angle_rad) {
  return (X_WT.translation() - X_WT_start.translation()).norm() < distance_m &&
         RotationAngle(X_WT.linear().transpose() * X_WT_start.linear()) < angle_rad;
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
    : X_WB_(params.X_WB),
      X_TF_(Pose(params.X_FT).inverse()),
      sensor_(params.sensor),
      feels_inertia_(params.sensor_feels_inertia),
      arm_(MakeArm(params)),
      hand_(params.hand, std::move(script)) {}

std::span<const std::uint8_t> SimulatedCell::Step(rt::Nanoseconds now, bool client_had_its_time) {
  // apply the client's answer and move the arm
  arm_->Move(client_had_its_time, F_hand_T_B_);
  static_cast<ArmStatus&>(state_) = arm_->status();
  const bool active = state_.session == control::SessionState::kCommandingActive;

  // the tool's true pose, which includes the base's displacement
  const ArmMotion arm = arm_->motion();
  const Pose X_WT = X_WB_ * arm.X_BBnow * arm.X_BT;
  const Twist V_WT{.v = X_WB_.linear() * arm.V_BT.v, .w = X_WB_.linear() * arm.V_BT.w};

  // the hand
  Wrench F_T_W;
  const bool holds = active && (holds_ || held_once_ || UpdateArrival(X_WT, V_WT));
  if (holds && !holds_) {
    held_cycles_ = 0;
    held_once_ = true;
    hand_.Reset();
  }
  holds_ = holds;
  if (holds) {
    state_.cell_time_s = static_cast<double>(++held_cycles_) * period_s();
    F_T_W = hand_.Step(state_.cell_time_s, period_s(), X_WT, V_WT);
  }

  F_hand_T_B_ = ExpressedIn(X_WB_.linear().transpose(), F_T_W);

  const auto datagram = arm_->Message(ExpressedIn(X_WT.linear().transpose(), F_T_W), now);

  ++state_.cycle;
  state_.stamp = now;
  // update again, because the message that was just made is counted too
  static_cast<ArmStatus&>(state_) = arm_->status();
  state_.active_once |= active;
  state_.script_done = state_.active_once && state_.cell_time_s >= hand_.script().duration_s();
  state_.q_meas = arm.q_meas;
  state_.q_cmd = arm.q_cmd;
  state_.X_WT_meas = X_WT;
  state_.v_WT_meas_m_per_s = V_WT.v;
  state_.w_WT_meas_rad_per_s = V_WT.w;
  state_.F_hand_T_W = F_T_W;
  state_.F_S = SensorLoad(sensor_, X_WT, X_WT * X_TF_, F_T_W);
  if (feels_inertia_) {
    // mean acceleration over the past period; 0 in the first period, where it is unknown
    const Twist& V_before = has_twist_ ? V_WT_before_ : V_WT;
    const Twist A_WT{.v = (V_WT.v - V_before.v) / period_s(), .w = (V_WT.w - V_before.w) / period_s()};
    state_.F_S = SubtractInertia(sensor_, state_.F_S,
                                 {.X_WT = X_WT, .X_WF = X_WT * X_TF_, .V_WT = V_WT, .A_WT = A_WT});
    V_WT_before_ = V_WT;
    has_twist_ = true;
  }
  return datagram;
}

// The hand does not touch the tool before the arm has arrived at the end of its start path. A compliant arm
// may sag and miss the start. The operator then takes the tool once it has been at rest for some time near
// the start.
bool SimulatedCell::UpdateArrival(const Pose& X_WT, const Twist& V_WT) {
  // The tool has arrived if it is within these bounds, or if it has been slow for some time within the wider
  // bounds below.
  constexpr double kArrived_m = 0.003, kArrived_rad = 0.03;
  constexpr double kWithinReach_m = 0.03, kWithinReach_rad = 0.3;
  constexpr double kMaxIdle_m_per_s = 0.02, kMaxIdle_rad_per_s = 0.2, kMinIdle_s = 0.3;
  const Pose X_WT_start = hand_.script().Sample(0.0).X_WT;
  const bool idle = V_WT.v.norm() < kMaxIdle_m_per_s && V_WT.w.norm() < kMaxIdle_rad_per_s;
  idle_s_ = idle && IsNear(X_WT, X_WT_start, kWithinReach_m, kWithinReach_rad) ? idle_s_ + period_s() : 0.0;
  return idle_s_ >= kMinIdle_s || IsNear(X_WT, X_WT_start, kArrived_m, kArrived_rad);
}

}  // namespace osteon::hil
