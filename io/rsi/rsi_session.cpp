#include "io/rsi/rsi_session.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "base/number_text.h"
#include "base/units.h"

namespace osteon::io {
namespace {

using control::SessionState;

constexpr std::int64_t kWindow = 64;  // number of IPOC steps that seen_ covers, one bit each
constexpr std::size_t kAxes = kRsiAxes;
// The period is measured over at least kPeriodMessages messages. The measured mean replaces the configured
// cycle only if they differ by at least the factor kOtherPeriod.
constexpr std::uint32_t kPeriodMessages = 10;
constexpr double kOtherPeriod = 2.0;

// @throws std::invalid_argument if `accepted` is false, with the parameter's name, the value found and the
// range.
void Require(bool accepted, const std::string& name, double found, const char* range) {
  if (!accepted)
    throw std::invalid_argument("RSI: " + name + ": found " + base::NumberText(found) + ", accepted " +
                                range);
}

kinematics::JointVectorN<6> ToRadians(const RsiAxes& axes_deg) OSTEON_RT {
  kinematics::JointVectorN<6> q;
  for (std::size_t i = 0; i < kAxes; ++i) q[static_cast<int>(i)] = axes_deg[i] * kDegree;
  return q;
}

// Returns A, B, C [deg] with R = Rz(A) Ry(B) Rx(C). If B is ±90 deg, A and C are not unique, and A is set to
// 0.
std::array<double, 3> ToAbcAngles(const Matrix3& R) OSTEON_RT {
  const double cos_b = std::hypot(R(0, 0), R(1, 0));
  const double b = std::atan2(-R(2, 0), cos_b) / kDegree;
  if (cos_b < 1e-9) return {0.0, b, std::atan2(-R(1, 2), R(1, 1)) / kDegree};
  return {std::atan2(R(1, 0), R(0, 0)) / kDegree, b, std::atan2(R(2, 1), R(2, 2)) / kDegree};
}

}  // namespace

RsiSession::RsiSession(const RsiSessionParams& params)
    : params_(params), decimals_(params.decimals < 0 ? RsiDecimals(params.layout) : params.decimals) {
  Require(params.cycle_ms == 4 || params.cycle_ms == 12, "cycle_ms", params.cycle_ms, "4 or 12");
  Require(params.ipoc_step >= 1 && params.ipoc_step <= 1000, "ipoc_step", params.ipoc_step,
          "1 … 1000: 1, or the cycle's milliseconds");
  Require(params.timeout_cycles >= 1, "timeout_cycles", params.timeout_cycles, ">= 1");
  Require(params.settle_messages >= 1, "settle_messages", params.settle_messages, ">= 1");
  Require(params.entry_step_deg > 0.0, "entry_step_deg", params.entry_step_deg, "> 0");
  Require(params.late_at_start >= 0, "late_at_start", params.late_at_start, ">= 0");
  Require(params.decimals >= -1 && params.decimals <= 9, "decimals", params.decimals,
          "0 … 9, or -1 for the layout's own");
  for (std::size_t i = 0; i < kAxes; ++i)
    Require(params.range[i] > 0.0 && params.range[i] <= 1e5, "range " + std::to_string(i + 1),
            params.range[i], "0 … 1e5, not 0");
  if (params.kind == RsiCorrection::kCartesian) {
    if (!params.arm)
      throw std::invalid_argument("RSI: Cartesian corrections need the arm's geometry (params.arm)");
    chain_.emplace(kinematics::ChainFrom(*params.arm));
  }
}

RsiAccept RsiSession::Accept(std::span<const std::uint8_t> datagram, rt::Nanoseconds stamp,
                             control::ArmState& state) OSTEON_RT {
  RsiRobotMessage message;
  const RsiError error = DecodeRobot(datagram, static_cast<std::uint16_t>(RsiElement::kAIPos), message);
  if (error) {
    last_error_ = error;
    CountRejected(state);
    return RsiAccept::kRejected;
  }

  RsiAccept result = RsiAccept::kAccepted;
  std::uint32_t ahead = 0;
  Order order = CheckSequence(message.ipoc, stamp, ahead);
  if (joined_late_ && order == Order::kNext && !TooLate(message)) order = Order::kFirst;
  switch (order) {
    case Order::kFirst:
      BeginSession(message);
      begun_ = stamp;
      period_ms_ = params_.cycle_ms;
      break;
    case Order::kNext:
      TrackCorrectionSum(ahead, message.delay.value_or(status_.delay + ahead - 1));
      break;
    case Order::kDuplicate:
      ++counters_.duplicate;
      result = RsiAccept::kDuplicate;
      break;
    case Order::kLate:
      ++counters_.reordered;
      result = RsiAccept::kLate;
      break;
  }
  if (result == RsiAccept::kAccepted) {
    last_ipoc_ = message.ipoc;
    ipoc_digits_ = message.ipoc_digits;
    last_stamp_ = stamp;
    status_.delay = message.delay.value_or(0);
    pending_ = !joined_late_;
    if (joined_late_) {
      ++counters_.rejected;
      result = RsiAccept::kJoinedLate;
    }
  }
  if (result == RsiAccept::kAccepted) {
    ++in_session_;
    if (in_session_ == static_cast<std::uint32_t>(params_.settle_messages) + 1) {
      ++activation_;
      holding_ = true;
    }
    PutMessage(message, stamp, state);
  }
  PutCounters(state);
  return result;
}

// Writes an accepted message into `state`. RSI sends no connection quality, safety state, drive state or
// mode. It runs only while the arm moves under position control, so these fields are constants.
void RsiSession::PutMessage(const RsiRobotMessage& message, rt::Nanoseconds stamp,
                            control::ArmState& state) OSTEON_RT {
  const bool settling = in_session_ <= static_cast<std::uint32_t>(params_.settle_messages);
  state.activation = activation_;
  state.holding = holding_;
  state.stamp = stamp;
  state.sequence = static_cast<std::uint32_t>(message.ipoc);
  state.session = settling ? SessionState::kCommandingWait : SessionState::kCommandingActive;
  state.quality = 3;
  state.safety_state = 0;
  state.drives_active = true;
  state.control_mode = control::ControlMode::kPosition;
  state.command_mode = control::CommandMode::kPosition;
  state.period_s = Period_s(stamp);
  state.q_meas = state.q_ipo = state.tau_ext = {};
  for (std::size_t i = 0; i < kAxes; ++i) {
    state.q_meas[i] = (*message.axes_measured)[i] * kDegree;
    state.q_ipo[i] = start_deg_[i] * kDegree;
  }
  state.has_ipo = true;
}

bool RsiSession::IsMessage(std::span<const std::uint8_t> datagram) const OSTEON_RT {
  RsiRobotMessage message;
  return !DecodeRobot(datagram, static_cast<std::uint16_t>(RsiElement::kAIPos), message);
}

// Compares a message's IPOC with those received before, and updates the counters of lost messages.
RsiSession::Order RsiSession::CheckSequence(std::uint64_t ipoc, rt::Nanoseconds stamp,
                                            std::uint32_t& ahead) OSTEON_RT {
  // unsigned difference, read as signed: correct if two numbers are less than 2^63 apart
  const auto apart = static_cast<std::int64_t>(ipoc - last_ipoc_);
  const std::int64_t steps = apart / params_.ipoc_step;
  const rt::Nanoseconds timeout = rt::kMillisecond * params_.cycle_ms * params_.timeout_cycles;
  if (!has_last_ || stamp - last_stamp_ > timeout || steps > params_.timeout_cycles || steps <= -kWindow)
    return Order::kFirst;
  if (apart > 0) {
    // a rise of IPOC by less than ipoc_step is accepted as one step
    ahead = static_cast<std::uint32_t>(std::max<std::int64_t>(1, steps));
    seen_ = ahead < kWindow ? (seen_ << ahead) | 1u : 1u;
    counters_.lost += ahead - 1;
    return Order::kNext;
  }
  const std::uint64_t bit = std::uint64_t{1} << -steps;
  if (seen_ & bit) return Order::kDuplicate;
  seen_ |= bit;
  if (counters_.lost > 0) --counters_.lost;  // it was counted as lost when a newer one overtook it
  return Order::kLate;
}

// Returns the controller's period [s]: the configured cycle, or the measured interval if the two differ by at
// least the factor kOtherPeriod. The interval is measured once per session: when settling ends, or after
// kPeriodMessages intervals if that is later.
double RsiSession::Period_s(rt::Nanoseconds stamp) OSTEON_RT {
  const auto settled = static_cast<std::uint32_t>(params_.settle_messages);
  if (in_session_ == std::max(settled, kPeriodMessages) + 1) {
    const double mean_ms = 1e3 * rt::ToSeconds(stamp - begun_) / (in_session_ - 1);
    const bool deviates = mean_ms >= kOtherPeriod * params_.cycle_ms ||
                          (mean_ms > 0.0 && mean_ms <= params_.cycle_ms / kOtherPeriod);
    if (deviates) period_ms_ = std::max(1.0, std::round(mean_ms));
  }
  return 1e-3 * period_ms_;
}

// Whether a session's first message shows that RSI was running before this side started.
bool RsiSession::TooLate(const RsiRobotMessage& first) const OSTEON_RT {
  return first.delay.value_or(0) > static_cast<std::uint32_t>(params_.late_at_start);
}

void RsiSession::BeginSession(const RsiRobotMessage& message) OSTEON_RT {
  has_last_ = true;
  seen_ = 1;
  in_session_ = 0;
  holding_ = false;
  awaiting_ = false;
  stop_ = false;
  total_ = sent_ = applied_ = sum_before_ = {};
  joined_late_ = TooLate(message);
  start_deg_ = message.axes_set.value_or(*message.axes_measured);
  if (chain_) X_BF_start_ = chain_->FlangePose(ToRadians(start_deg_));
  status_.sum = {};
  if (!joined_late_) ++status_.sessions;
}

// Computes the controller's sum of corrections after `ahead` cycles, from the rise of Delay. Our last answer
// belongs to the first of these cycles, and may have come in time or too late. The other cycles had no
// answer, because their messages never reached us.
void RsiSession::TrackCorrectionSum(std::uint32_t ahead, std::uint32_t delay) OSTEON_RT {
  // On some controllers Delay only rises; on others an answer in time resets it to 0.
  const std::uint32_t delay_rise = delay >= status_.delay ? delay - status_.delay : delay;
  const bool in_time = awaiting_ && delay_rise < ahead;
  if (in_time) applied_ = sent_;
  const std::uint32_t unanswered = in_time ? ahead - 1 : ahead;
  if (params_.absolute) {
    if (unanswered > 0) status_.sum = params_.hold_on ? applied_ : Six{};
  } else {
    if (awaiting_ && !in_time) status_.sum = sum_before_;
    if (params_.hold_on)
      for (std::size_t i = 0; i < kAxes; ++i) status_.sum[i] += unanswered * applied_[i];
  }
  awaiting_ = false;
}

// Whether a command may move the arm: the arm has settled, the command names the present activation, and the
// activation's first command is within entry_step_deg of the start pose.
bool RsiSession::MayMove(const control::ArmCommand& command) OSTEON_RT {
  if (in_session_ <= static_cast<std::uint32_t>(params_.settle_messages)) return false;
  if (command.activation != activation_) return false;
  for (std::size_t i = 0; holding_ && i < kAxes; ++i)
    if (!(std::abs(command.q[i] / kDegree - start_deg_[i]) <= params_.entry_step_deg)) return false;
  holding_ = false;
  return true;
}

// Computes the correction from the start pose for the command; false if it may not be sent.
bool RsiSession::ComputeCorrection(const control::ArmCommand& command, Six& correction) OSTEON_RT {
  kinematics::JointVectorN<6> q;
  for (std::size_t i = 0; i < kAxes; ++i) q[static_cast<int>(i)] = command.q[i];
  if (!q.allFinite()) {
    ++status_.not_finite;
    return false;
  }
  if (params_.kind == RsiCorrection::kAxes) {
    for (std::size_t i = 0; i < kAxes; ++i) correction[i] = command.q[i] / kDegree - start_deg_[i];
  } else {
    const Pose X_BF = chain_->FlangePose(q);
    const Vector3 p_mm = 1e3 * (X_BF.translation() - X_BF_start_.translation());
    const std::array<double, 3> abc = ToAbcAngles(X_BF.linear() * X_BF_start_.linear().transpose());
    correction = {p_mm.x(), p_mm.y(), p_mm.z(), abc[0], abc[1], abc[2]};
  }
  for (std::size_t i = 0; i < kAxes; ++i) {
    if (std::abs(correction[i]) <= params_.range[i]) continue;
    ++status_.out_of_range;
    status_.worst = static_cast<std::uint8_t>(i + 1);
    return false;
  }
  return true;
}

std::span<const std::uint8_t> RsiSession::Answer(const control::ArmCommand& command) OSTEON_RT {
  if (!pending_) return {};
  Six total = total_;
  if (!stop_ && !(MayMove(command) && ComputeCorrection(command, total))) total = total_;

  RsiAnswer answer{.layout = params_.layout,
                   .kind = params_.kind,
                   .correction = total,
                   .stop = stop_,
                   .ipoc = last_ipoc_,
                   .ipoc_digits = ipoc_digits_};
  if (!params_.absolute)
    for (std::size_t i = 0; i < kAxes; ++i) answer.correction[i] = total[i] - status_.sum[i];
  for (double& value : answer.correction) value = RsiRounded(value, decimals_);

  std::size_t size = 0;
  if (EncodeAnswer(answer, decimals_, buffer_, size) != RsiErrorCode::kNone) return {};
  total_ = total;
  sent_ = answer.correction;
  sum_before_ = status_.sum;
  for (std::size_t i = 0; i < kAxes; ++i)
    status_.sum[i] = params_.absolute ? sent_[i] : sum_before_[i] + sent_[i];
  pending_ = false;
  awaiting_ = true;
  return {buffer_.data(), size};
}

void RsiSession::CountLate(control::ArmState& state) OSTEON_RT {
  ++counters_.late;
  PutCounters(state);
}

void RsiSession::CountRejected(control::ArmState& state) OSTEON_RT {
  ++counters_.rejected;
  PutCounters(state);
}

void RsiSession::PutCounters(control::ArmState& state) const OSTEON_RT {
  state.lost = counters_.lost;
  state.duplicate = counters_.duplicate;
  state.late = counters_.late;
  state.reordered = counters_.reordered;
  state.rejected = counters_.rejected;
}

}  // namespace osteon::io
