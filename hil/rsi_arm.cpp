#include "hil/rsi_arm.h"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "base/units.h"

namespace osteon::hil {
namespace {

// Returns the controller's parameters with start_deg set to q_start [rad].
RsiControllerParams WithStart(RsiControllerParams params, const control::JointArray& q_start) {
  for (std::size_t i = 0; i < 6; ++i) params.start_deg[i] = q_start[i] / kDegree;
  return params;
}

RsiCounters AddCounters(const RsiCounters& a, const RsiCounters& b) {
  return {.sent = a.sent + b.sent,
          .answered = a.answered + b.answered,
          .missed = a.missed + b.missed,
          .excused = a.excused + b.excused,
          .late = a.late + b.late,
          .wrong_ipoc = a.wrong_ipoc + b.wrong_ipoc,
          .duplicate = a.duplicate + b.duplicate,
          .malformed = a.malformed + b.malformed};
}

}  // namespace

RsiArm::RsiArm(const RsiArmParams& params, const control::JointArray& q_start, const Pose& X_FT)
    : params_(params),
      X_FT_(X_FT),
      controller_(WithStart(params.controller, q_start)),
      arm_(params.controller.arm) {
  if (params.handed_over_answers < 1)
    throw std::invalid_argument(fmt::format("simulated KR: handed_over_answers: found {}, accepted >= 1",
                                            params.handed_over_answers));
  if (!(params.start_again_s >= 0.0))
    throw std::invalid_argument(
        fmt::format("simulated KR: start_again_s: found {}, accepted >= 0", params.start_again_s));
}

void RsiArm::Move(bool client_had_its_time, const Wrench&) {
  if (StartsAgain() && ++idle_cycles_ * period_s() >= params_.start_again_s) Restart();
  message_ = controller_.Step(client_had_its_time);
}

std::span<const std::uint8_t> RsiArm::Message(const Wrench&, rt::Nanoseconds) { return message_; }

// Whether the operator at the pad starts the program again.
bool RsiArm::StartsAgain() const {
  const RsiControllerState& state = controller_.state();
  if (!power_ || state.stop.reason != RsiStopReason::kTimeout) return false;
  return state.counters.answered == 0 || params_.start_again_after_loss;
}

// Starts RSI again, and keeps the counters and the stop report of the session that has ended.
void RsiArm::Restart() {
  before_ = AddCounters(before_, controller_.state().counters);
  // A session without any answer had no client, so its end does not replace the last stop report.
  if (controller_.state().counters.answered > 0) last_stop_ = controller_.state().stop;
  controller_.Restart();
  idle_cycles_ = 0;
}

void RsiArm::SetPower(bool on) {
  if (on == power_) return;
  power_ = on;
  if (!on) return controller_.PowerOff();
  Restart();
  last_stop_ = {};  // restoring the power acknowledges the stop
}

ArmMotion RsiArm::motion() const {
  const kinematics::JointVectorN<6>& q = controller_.q();
  const Eigen::Matrix<double, 6, 1> V_BT = arm_.JacobianAt(q, X_FT_.translation()) * controller_.qd();
  ArmMotion motion{.q_meas = {},
                   .q_cmd = {},
                   .X_BT = arm_.FlangePose(q) * X_FT_,
                   .V_BT = {.v = V_BT.head<3>(), .w = V_BT.tail<3>()}};
  for (std::size_t i = 0; i < 6; ++i) {
    motion.q_meas[i] = q[static_cast<int>(i)];
    motion.q_cmd[i] = controller_.state().axes_set_deg[i] * kDegree;
  }
  return motion;
}

ArmStatus RsiArm::status() const {
  const RsiControllerState& state = controller_.state();
  const auto answered = state.counters.answered;
  const RsiCounters total = AddCounters(before_, state.counters);
  ArmStatus status;
  status.session = !state.running  ? control::SessionState::kIdle
                   : answered == 0 ? control::SessionState::kMonitoringWait
                   : answered < static_cast<std::uint64_t>(params_.handed_over_answers)
                       ? control::SessionState::kCommandingWait
                       : control::SessionState::kCommandingActive;
  status.counters.sent = total.sent;
  status.counters.answered = total.answered;
  status.counters.lost = total.missed;
  status.counters.excused = total.excused;
  status.counters.stale = total.late;
  status.counters.duplicate = total.duplicate;
  status.counters.malformed = total.malformed + total.wrong_ipoc;
  status.rsi_stop = state.running ? last_stop_ : state.stop;
  status.delay = state.delay;
  return status;
}

}  // namespace osteon::hil
