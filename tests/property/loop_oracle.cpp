#include "tests/property/loop_oracle.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "tests/property/wild_zone.h"

namespace osteon::property {
namespace {

using control::JointArray;
using control::Phase;

constexpr double kReduced_m_per_s = 0.25;  // speed limit in the mode T1, ISO 10218-1
// A straight step of the tool and the corresponding joint step differ in second order. A step of 0.25 mm and
// 1.5 mrad at a reach of 1.2 m differs by 1 %, and by more if the arm is nearly stretched. Beyond 10 % the
// loop stops.
constexpr double kCurvatureFactor = 1.1;
constexpr double kRounding = 1.0 + 1e-9;
// A tick's path is known to second order; the third order, at 1 rad/s of every joint, is some nanometres.
constexpr double kOnTheBound_m = 1e-8;
// Time to slow from 0.5 m/s to half of it, at a joint deceleration of 34 rad/s^2, at least 0.3 m from the
// joint's axis.
constexpr int kSlowingTicks = 20;
constexpr double kSlopeError_Nm = 1e-4;  // error of a slope by finite differences

bool AllFinite(const JointArray& q) {
  return std::all_of(q.begin(), q.end(), [](double x) { return std::isfinite(x); });
}

}  // namespace

ArmPoints PointsOfIiwa(const JointArray& q, double tool_m) {
  // lengths along the joints' axes, then twists (Denavit-Hartenberg d [m] and alpha)
  constexpr std::array<double, 7> kD{0.36, 0.0, 0.42, 0.0, 0.4, 0.0, 0.126};
  constexpr std::array<int, 7> kAlpha{-1, 1, 1, -1, -1, 1, 0};  // quarter turns
  Matrix3 R = Matrix3::Identity();
  Vector3 p = Vector3::Zero();
  ArmPoints points;
  for (std::size_t i = 0; i < 7; ++i) {
    const double c = std::cos(q[i]), s = std::sin(q[i]);
    Matrix3 turn, twist;
    turn << c, -s, 0, s, c, 0, 0, 0, 1;
    const double a = kAlpha[i];
    twist << 1, 0, 0, 0, a == 0 ? 1 : 0, -a, 0, a, a == 0 ? 1 : 0;
    p += kD[i] * R.col(2);
    R = R * turn * twist;
    if (i == 2) points.p_elbow_m = p;
  }
  points.p_flange_m = p;
  points.p_tool_m = p + tool_m * R.col(2);
  points.R_flange = R;
  return points;
}

void LoopOracle::BeforeTick(const control::ServoLoop& loop, const control::ArmState& state,
                            control::ReceiveResult received, const PersonsRequests& asked) {
  phase_before_ = loop.phase();
  faults_before_ = loop.faults().bits();
  recovers_ = asked.recover && loop.CanRecover();
  reduced_ = state.operation_mode == 0;
  from_ = before_;
  const bool read = received == control::ReceiveResult::kOk && AllFinite(state.q_meas) &&
                    (!state.has_ipo || AllFinite(state.q_ipo));
  // an arm that has not left the activation in which the loop commanded it stays at its last command
  const bool active = state.session == control::SessionState::kCommandingActive;
  const bool in_other_activation =
      state.activation != activation_ && (phase_before_ != Phase::kStopped || recovers_);
  const bool has_left = read && commanded_ && (!active || in_other_activation);
  if (has_left) commanded_ = false;
  const bool moves_itself =
      !active || has_left || ((phase_before_ == Phase::kWaiting || recovers_) && !commanded_);
  reduced_ticks_ = read && reduced_ ? reduced_ticks_ + 1 : read ? 0 : reduced_ticks_;
  NotePause(loop, read, asked);
  // if the loop does not command the arm, the next command must start at the position in the arm's message;
  // an idle arm reports none
  if (read && moves_itself && state.session != control::SessionState::kIdle)
    from_ = state.has_ipo ? state.q_ipo : state.q_meas;
  q_meas_ = state.q_meas;
  overloaded_ = allowed_.body && read &&
                torques_.Beyond_Nm(*allowed_.body, from_.value_or(before_), state.tau_ext) > kSlopeError_Nm;
}

// A pause requested while the loop waits or moves lasts from the next message until a resume.
void LoopOracle::NotePause(const control::ServoLoop& loop, bool read, const PersonsRequests& asked) {
  if (asked.resume || recovers_) paused_ = false;
  const safety::CellState state = loop.state();
  pause_asked_ |=
      asked.pause && (safety::IsMotion(state) || safety::Waits(state)) && state != safety::CellState::kOff;
  if (!pause_asked_ || !read) return;
  paused_ = true;
  pause_asked_ = false;
}

// Checks a loop that is paused, overloaded or faulty. @returns the violation; empty if there is none.
std::string LoopOracle::CheckStandstill(const control::ServoLoop& loop, const control::TickRecord& record,
                                        const control::ArmCommand& command) const {
  if (paused_ && (record.phase == Phase::kHaptic || record.phase == Phase::kAligning))
    return "goes on in a pause";
  if (paused_ && loop.cell_commands().spindle_rad_per_s != 0.0) return "a spindle that turns in a pause";
  if (paused_ && commanded_ && phase_before_ == Phase::kWaiting && record.phase == Phase::kWaiting &&
      from_ == before_ && command.q != before_)
    return "moves in a pause";
  if (overloaded_ && (record.phase == Phase::kHaptic || record.phase == Phase::kAligning))
    return "goes on where a joint bears more than it holds";
  // these faults are found in the rendered motion; all others are found before rendering
  constexpr auto kFoundAfterRendering = static_cast<std::uint32_t>(safety::Fault::kToolSpeed) |
                                        static_cast<std::uint32_t>(safety::Fault::kWorkspace) |
                                        static_cast<std::uint32_t>(safety::Fault::kJointLimit) |
                                        static_cast<std::uint32_t>(safety::Fault::kInverseKinematics);
  // the record still contains the computed force, within the limits. Nobody feels it, because the cell has
  // left rendering
  const bool renders = safety::Renders(static_cast<safety::CellState>(record.cell_state));
  if ((record.faults & ~kFoundAfterRendering) != 0 && renders)
    return "renders on in the tick that sees a fault";
  return {};
}

std::string LoopOracle::AfterTick(const control::ServoLoop& loop, const control::TickRecord& record,
                                  const control::ArmCommand& command) {
  rendered_ += record.phase == Phase::kHaptic;
  if (record.phase == Phase::kHaptic || record.phase == Phase::kAligning) {
    commanded_ = true;
    activation_ = command.activation;
  }
  if (!AllFinite(command.q)) return "a command that is not finite";
  if (faults_before_ != 0 && !recovers_ && (record.faults & faults_before_) != faults_before_)
    return "a fault that was latched is gone";
  if (record.faults != 0 && record.phase == Phase::kHaptic) return "renders with a fault";
  if (phase_before_ == Phase::kStopped && !recovers_ && record.phase != Phase::kStopped)
    return "goes on after a stop";
  if (std::string wrong = CheckStandstill(loop, record, command); !wrong.empty()) return wrong;
  if (std::string wrong = CheckWrenches(record, command); !wrong.empty()) return wrong;
  const double spindle = loop.cell_commands().spindle_rad_per_s;
  if (!(spindle >= 0.0 && spindle <= allowed_.spindle_rad_per_s)) return "a spindle beyond its speed";
  if (spindle != 0.0 && record.phase != Phase::kHaptic)
    return "a spindle that turns while nothing is rendered";
  std::string wrong = CheckStep(command.q, record.phase);
  if (!wrong.empty())
    wrong += fmt::format(" (phase {} → {}, state {}, faults {:#x})", static_cast<int>(phase_before_),
                         static_cast<int>(record.phase), record.cell_state, record.faults);
  before_ = command.q;
  return wrong;
}

std::string LoopOracle::CheckWrenches(const control::TickRecord& record,
                                      const control::ArmCommand& command) const {
  const Vector3 f(record.F_coupling_T_W.f), t(record.F_coupling_T_W.t);
  if (!(f.norm() <= allowed_.force_N * kRounding && t.norm() <= allowed_.torque_Nm * kRounding))
    return fmt::format("renders {} N, {} Nm", f.norm(), t.norm());
  const Vector3 overlay(command.F.f), overlay_t(command.F.t);
  if (!(overlay.norm() <= allowed_.force_N * kRounding && overlay_t.norm() <= allowed_.torque_Nm * kRounding))
    return fmt::format("overlays {} N, {} Nm", overlay.norm(), overlay_t.norm());
  // a wrench at its limits, at the end of the longest lever, 1.15 m from the shoulder's axis
  const double max_Nm = 1.15 * allowed_.force_N + allowed_.torque_Nm;
  for (const double tau : command.tau)
    if (!(std::abs(tau) <= max_Nm)) return fmt::format("overlays {} Nm on a joint", tau);
  if (allowed_.body && command.tau != JointArray{}) {
    const JointArray gravity_Nm = GravityByEnergy(*allowed_.body, q_meas_);
    for (std::size_t i = 0; i < 7; ++i)
      if (!(std::abs(command.tau[i]) + std::abs(gravity_Nm[i]) <=
            allowed_.body->joints[i].limits.torque_Nm + kSlopeError_Nm))
        return fmt::format("overlays {} Nm on joint {} beside {} of gravity", command.tau[i], i + 1,
                           gravity_Nm[i]);
  }
  if (allowed_.law == control::Law::kAdmittance && (!overlay.isZero(0.0) || command.tau != JointArray{}))
    return "overlays a wrench in position mode";
  return {};
}

std::string LoopOracle::CheckStep(const JointArray& to, Phase phase) {
  if (!from_) return {};
  const JointArray& from = *from_;
  const double dt_s = allowed_.period_s;
  for (std::size_t i = 0; i < 7; ++i) {
    const kinematics::JointLimits& limit = allowed_.joints[i];
    const double max_step_rad = limit.velocity_rad_per_s * allowed_.joint_speed_share * dt_s;
    // the command is a sum of steps, so its rounding error is relative to the joint's angle, not to the step
    const double digit_rad = 1e-15 * std::max(1.0, std::abs(from[i]));
    if (!(std::abs(to[i] - from[i]) <= max_step_rad * kRounding + digit_rad))
      return fmt::format("joint {} steps by {} rad, at most {}", i + 1, to[i] - from[i], max_step_rad);
    const double lower = limit.lower_rad + allowed_.joint_margin_rad,
                 upper = limit.upper_rad - allowed_.joint_margin_rad;
    if (from[i] >= lower && from[i] <= upper && !(to[i] >= lower - 1e-9 && to[i] <= upper + 1e-9))
      return fmt::format("joint {} leaves its range: {} rad", i + 1, to[i]);
  }
  if (allowed_.law != control::Law::kAdmittance || phase == Phase::kAligning) return {};

  const ArmPoints a = PointsOfIiwa(from, allowed_.tool_m), b = PointsOfIiwa(to, allowed_.tool_m);
  const double step_m = (b.p_tool_m - a.p_tool_m).norm();
  const double max_step_m =
      (reduced_ ? std::min(allowed_.speed_m_per_s, kReduced_m_per_s) : allowed_.speed_m_per_s) * dt_s;
  // if T1 is chosen during a motion, the tool may be faster for some ticks: it brakes as fast as the joints'
  // accelerations permit
  const double braking_step_m = reduced_ticks_ <= kSlowingTicks ? way_before_m_ : 0.0;
  if (!(step_m <=
        std::max(max_step_m * kCurvatureFactor, reduced_ ? braking_step_m * kRounding : 0.0) + 1e-12))
    return fmt::format("the tool steps by {} m, at most {}", step_m, max_step_m);
  way_before_m_ = step_m;
  most_speed_ = std::max(most_speed_, step_m / max_step_m);
  const double turn_rad = Eigen::AngleAxisd(a.R_flange.transpose() * b.R_flange).angle();
  // the rounding error of a rotation matrix's angle is 1e-8
  if (!(turn_rad <= allowed_.turn_rad_per_s * dt_s * kCurvatureFactor + 1e-7))
    return fmt::format("the tool turns by {} rad, at most {}", turn_rad, allowed_.turn_rad_per_s * dt_s);
  const double elbow_m = (b.p_elbow_m - a.p_elbow_m).norm();
  if (allowed_.elbow_speed_m_per_s > 0.0 &&
      !(elbow_m <= allowed_.elbow_speed_m_per_s * dt_s * kCurvatureFactor))
    return fmt::format("the elbow steps by {} m, at most {}", elbow_m, allowed_.elbow_speed_m_per_s * dt_s);

  const auto inside_m = [this](const ArmPoints& points) {
    return std::min({allowed_.radius_m - (points.p_tool_m - allowed_.sphere_m).norm(),
                     points.p_tool_m.z() - allowed_.floor_m,
                     points.p_flange_m.z() - allowed_.flange_floor_m});
  };
  if (inside_m(a) >= 0.0 && !(inside_m(b) >= -kOnTheBound_m))
    return fmt::format("leaves the workspace by {} m", -inside_m(b));
  if (!allowed_.zone) return {};
  const auto past_m = [this](const ArmPoints& points) {
    return PastBound_m(*allowed_.zone, PointOf(points, allowed_.zone->point));
  };
  if (past_m(a) <= 0.0 && !(past_m(b) <= kOnTheBound_m))
    return fmt::format("goes past a zone's bound by {} m", past_m(b));
  return {};
}

}  // namespace osteon::property
