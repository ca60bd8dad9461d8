#include "hil/fri_server.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace osteon::hil {
namespace {

using control::SessionState;
using kinematics::JointVector;

constexpr int kGood = 2;
constexpr std::uint8_t kSafetyNormal = 0, kSafetyStopLevel1 = 2, kDrivesOff = 0, kDrivesActive = 2;

void Require(bool accepted, std::string_view name, double found, std::string_view range) {
  if (!accepted)
    throw std::invalid_argument(fmt::format("simulated arm: {}: found {}, accepted {}", name, found, range));
}

control::JointArray ToArray(const JointVector& q) {
  control::JointArray array{};
  std::copy_n(q.data(), control::kJoints, array.begin());
  return array;
}

int AnswersPerSecond(const FriServerParams& params) {
  Require(params.send_period_ms >= 1 && params.send_period_ms <= 100, "send_period_ms", params.send_period_ms,
          "1 … 100");
  Require(params.receive_multiplier >= 1 && params.receive_multiplier <= 100, "receive_multiplier",
          params.receive_multiplier, "1 … 100");
  return 1000 / (params.send_period_ms * params.receive_multiplier);
}

}  // namespace

std::string Describe(const StopReport& stop) {
  switch (stop.reason) {
    case StopReason::kNone:
      return "none";
    case StopReason::kQualityTimeout:
      return fmt::format("timeout before quality GOOD: session closed after {:g} s", stop.accepted);
    case StopReason::kLostInARow:
      return fmt::format("{:g} answers in a row lost, the arm ends commanding at {:g}", stop.found,
                         stop.accepted);
    case StopReason::kLostPerSecond:
      return fmt::format("{:g} answers lost within a second, the arm ends commanding at {:g}", stop.found,
                         stop.accepted);
    case StopReason::kNotMirrored:
      return fmt::format(
          "not mirrored: A{} commanded {:.4f} rad off the interpolator before the motion began, accepted "
          "{:.4f}",
          stop.joint, stop.found, stop.accepted);
    case StopReason::kJointCount:
      return fmt::format("joint count: {:g} joint values in a command, accepted {:g}", stop.found,
                         stop.accepted);
    case StopReason::kNotFinite:
      return fmt::format("not finite: A{} commanded {}", stop.joint, stop.found);
    case StopReason::kJointLimit:
      return fmt::format("joint limit: A{} commanded {:.4f} rad, accepted at {} {:.4f}", stop.joint,
                         stop.found, stop.found > stop.accepted ? "most" : "least", stop.accepted);
    case StopReason::kJointStep:
      return fmt::format("joint step: A{} moved {:.5f} rad in one command, accepted {:.5f}", stop.joint,
                         stop.found, stop.accepted);
  }
  return "unknown";
}

FriServer::FriServer(const FriServerParams& params, const std::array<kinematics::JointLimits, 7>& limits,
                     const JointVector& q_start)
    : params_(params),
      limits_(limits),
      quality_(params.quality, AnswersPerSecond(params)),
      q_commanded_(q_start),
      q_ipo_(q_start) {
  Require(params.request_after_good_cycles >= 1, "request_after_good_cycles",
          params.request_after_good_cycles, ">= 1");
  Require(params.activate_after_mirrored_answers >= 1, "activate_after_mirrored_answers",
          params.activate_after_mirrored_answers, ">= 1");
  Require(params.step_margin >= 1.0 && params.step_margin <= 100.0, "step_margin", params.step_margin,
          "1 … 100");
  Require(params.mirror_tolerance_rad > 0.0, "mirror_tolerance_rad", params.mirror_tolerance_rad, "> 0");
  Require(params.tracking_error_zero_rad > 0.0, "tracking_error_zero_rad", params.tracking_error_zero_rad,
          "> 0");
  for (int i = 0; i < control::kJoints; ++i) {
    const kinematics::JointLimits& limit = limits[static_cast<std::size_t>(i)];
    Require(limit.lower_rad < limit.upper_rad, fmt::format("upper position limit of A{} [rad]", i + 1),
            limit.upper_rad, fmt::format("above the lower limit {}", limit.lower_rad));
    Require(limit.velocity_rad_per_s > 0.0, fmt::format("velocity limit of A{} [rad/s]", i + 1),
            limit.velocity_rad_per_s, "> 0");
    Require(q_start[i] >= limit.lower_rad && q_start[i] <= limit.upper_rad,
            fmt::format("start position of A{} [rad]", i + 1), q_start[i],
            fmt::format("{} … {}", limit.lower_rad, limit.upper_rad));
  }
}

void FriServer::Open() {
  quality_.Reset();
  state_ = SessionState::kMonitoringWait;
  safety_stopped_ = was_good_ = has_pending_ = turn_answered_ = turn_excused_ = false;
  program_asks_ = true;
  cycles_in_session_ = good_cycles_ = mirrored_ = cycles_in_turn_ = 0;
  stop_ = {};
}

bool FriServer::Receive(std::span<const std::uint8_t> datagram) {
  const auto command = codec_.Decode(datagram);
  if (!command || counters_.sent == 0 || state_ == SessionState::kIdle) {
    ++counters_.malformed;
    return false;
  }
  // Counters wrap at 2^32, so "how long ago" is a difference. More than half the range ago is the future:
  // made up.
  const std::uint32_t messages_ago = sequence_ - command->reflected_sequence;
  if (messages_ago > 0x7fffffffu) {
    ++counters_.malformed;
    return false;
  }
  if (any_answer_ && command->reflected_sequence == answered_sequence_) {
    ++counters_.duplicate;
    return false;
  }
  if (messages_ago >= static_cast<std::uint32_t>(params_.receive_multiplier)) {
    ++counters_.stale;
    return false;
  }
  client_sequence_ = command->sequence;
  answered_sequence_ = command->reflected_sequence;
  any_answer_ = has_pending_ = true;
  pending_ = *command;
  return true;
}

void FriServer::EndCycle(bool client_had_its_time) {
  if (state_ == SessionState::kIdle || counters_.sent == 0) return;
  ++cycles_in_session_;
  ++cycles_since_command_;
  if (has_pending_ && Commanding() && !pending_.has_joint_position) {
    ++counters_.incomplete;
    has_pending_ = false;
  }
  CountAnswer(client_had_its_time);

  switch (state_) {
    case SessionState::kIdle:
      break;
    case SessionState::kMonitoringWait:
    case SessionState::kMonitoringReady:
      WalkMonitoring();
      break;
    case SessionState::kCommandingWait:
      WalkCommandingWait();
      break;
    case SessionState::kCommandingActive:
      if (has_pending_) Follow();
      break;
  }
  if (Commanding()) EndOnLosses();
  has_pending_ = false;
}

std::span<const std::uint8_t> FriServer::BeginCycle(const ArmMeasurement& measured, rt::Nanoseconds stamp) {
  if (state_ == SessionState::kIdle) return {};
  ++counters_.sent;
  FriMonitoring m;
  m.sequence = ++sequence_;
  m.reflected_sequence = client_sequence_;
  m.session = state_;
  m.quality = static_cast<std::uint8_t>(quality_.level());
  m.safety_state = safety_stopped_ ? kSafetyStopLevel1 : kSafetyNormal;
  m.drive_state = safety_stopped_ ? kDrivesOff : kDrivesActive;
  m.send_period_ms = static_cast<std::uint32_t>(params_.send_period_ms);
  m.receive_multiplier = static_cast<std::uint32_t>(params_.receive_multiplier);
  m.q_meas = ToArray(measured.q);
  m.q_cmd = ToArray(q_commanded_);
  // A position servo without link masses: what the joints measure is what the hand does to them.
  m.tau_meas = m.tau_ext = ToArray(measured.tau_ext);
  m.has_ipo = Commanding();
  if (m.has_ipo) m.q_ipo = ToArray(q_ipo_);
  if (state_ == SessionState::kCommandingActive) {
    const double error_rad = (q_commanded_ - measured.q).cwiseAbs().maxCoeff();
    m.tracking_performance = std::clamp(1.0 - error_rad / params_.tracking_error_zero_rad, 0.0, 1.0);
  }
  m.stamp = stamp;
  return codec_.Encode(m);
}

bool FriServer::Commanding() const {
  return state_ == SessionState::kCommandingWait || state_ == SessionState::kCommandingActive;
}

void FriServer::CountAnswer(bool client_had_its_time) {
  turn_answered_ |= has_pending_;
  turn_excused_ |= !client_had_its_time;
  if (++cycles_in_turn_ < params_.receive_multiplier) return;
  if (turn_answered_) {
    ++counters_.answered;
    quality_.Add(Answer::kReceived);
  } else if (turn_excused_) {
    ++counters_.excused;
    quality_.Add(Answer::kExcused);
  } else {
    ++counters_.lost;
    quality_.Add(Answer::kLost);
  }
  cycles_in_turn_ = 0;
  turn_answered_ = turn_excused_ = false;
}

void FriServer::WalkMonitoring() {
  const bool good = quality_.level() >= kGood;
  was_good_ |= good;
  if (!was_good_ && cycles_in_session_ * period_s() >= params_.quality.good_timeout_s) {
    stop_ = Report(StopReason::kQualityTimeout, 0, 0.0, params_.quality.good_timeout_s);
    state_ = SessionState::kIdle;
    return;
  }
  state_ = good ? SessionState::kMonitoringReady : SessionState::kMonitoringWait;
  good_cycles_ = good ? good_cycles_ + 1 : 0;
  if (program_asks_ && good_cycles_ > params_.request_after_good_cycles) {
    state_ = SessionState::kCommandingWait;
    q_ipo_ = q_commanded_;
    mirrored_ = 0;
  }
}

void FriServer::WalkCommandingWait() {
  if (has_pending_) {
    if (pending_.joint_count != control::kJoints)
      return SafetyStop(StopReason::kJointCount, 0, pending_.joint_count, control::kJoints);
    for (int i = 0; i < control::kJoints; ++i) {
      const double off_rad = std::abs(pending_.q[static_cast<std::size_t>(i)] - q_ipo_[i]);
      if (!(off_rad <= params_.mirror_tolerance_rad))  // NaN as well
        return SafetyStop(StopReason::kNotMirrored, i + 1, off_rad, params_.mirror_tolerance_rad);
    }
    ++mirrored_;
  }
  if (quality_.level() < kGood) {
    LeaveCommanding();
  } else if (mirrored_ >= params_.activate_after_mirrored_answers) {
    state_ = SessionState::kCommandingActive;
    cycles_since_command_ = 0;
  }
}

void FriServer::Follow() {
  if (pending_.joint_count != control::kJoints)
    return SafetyStop(StopReason::kJointCount, 0, pending_.joint_count, control::kJoints);
  for (int i = 0; i < control::kJoints; ++i) {
    const double q_rad = pending_.q[static_cast<std::size_t>(i)];
    const kinematics::JointLimits& limit = limits_[static_cast<std::size_t>(i)];
    if (!std::isfinite(q_rad)) return SafetyStop(StopReason::kNotFinite, i + 1, q_rad, limit.upper_rad);
    if (q_rad > limit.upper_rad) return SafetyStop(StopReason::kJointLimit, i + 1, q_rad, limit.upper_rad);
    if (q_rad < limit.lower_rad) return SafetyStop(StopReason::kJointLimit, i + 1, q_rad, limit.lower_rad);
    const double step_rad = std::abs(q_rad - q_commanded_[i]);
    const double max_step_rad =
        limit.velocity_rad_per_s * period_s() * cycles_since_command_ * params_.step_margin;
    if (step_rad > max_step_rad) return SafetyStop(StopReason::kJointStep, i + 1, step_rad, max_step_rad);
  }
  q_commanded_ = Eigen::Map<const JointVector>(pending_.q.data());
  cycles_since_command_ = 0;
}

void FriServer::EndOnLosses() {
  StopReason reason = StopReason::kNone;
  if (quality_.TooManyInARow()) {
    reason = StopReason::kLostInARow;
    stop_ = Report(reason, 0, quality_.lost_in_a_row(), params_.quality.end_after_lost_in_a_row);
  } else if (quality_.TooManyPerSecond()) {
    reason = StopReason::kLostPerSecond;
    stop_ = Report(reason, 0, quality_.lost_per_s(), params_.quality.end_after_lost_per_s);
  }
  if (reason == StopReason::kNone) return;
  program_asks_ = params_.request_again_after_loss;
  LeaveCommanding();
}

void FriServer::LeaveCommanding() {
  state_ = quality_.level() >= kGood ? SessionState::kMonitoringReady : SessionState::kMonitoringWait;
  good_cycles_ = 0;
}

void FriServer::SafetyStop(StopReason reason, int joint, double found, double accepted) {
  stop_ = Report(reason, joint, found, accepted);
  safety_stopped_ = true;
  program_asks_ = false;
  LeaveCommanding();
}

StopReport FriServer::Report(StopReason reason, int joint, double found, double accepted) const {
  return {.reason = reason, .sequence = sequence_, .joint = joint, .found = found, .accepted = accepted};
}

}  // namespace osteon::hil
