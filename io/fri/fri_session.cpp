#include "io/fri/fri_session.h"

#include <algorithm>
#include <cmath>

namespace osteon::io {
namespace {

using control::SessionState;

constexpr std::int32_t kWindow = 64;  // counters that seen_ remembers

bool IsFinite(const control::JointArray& q) OSTEON_RT {
  return std::all_of(q.begin(), q.end(), [](double joint) { return std::isfinite(joint); });
}

}  // namespace

FriAccept FriSession::Accept(std::span<const std::uint8_t> datagram, rt::Nanoseconds stamp,
                             control::ArmState& state) OSTEON_RT {
  MonitoringMessage message;
  FriAccept result = FriAccept::kRejected;
  const CodecError error = DecodeMonitoring(datagram, message);
  if (error != CodecError::kNone) {
    last_error_ = error;
    ++counters_.rejected;
  } else {
    result = CheckSequence(message);
  }

  if (result == FriAccept::kAccepted) {
    last_ = message;
    has_last_ = pending_ = true;
    state.stamp = stamp;
    state.sequence = message.sequence;
    state.session = message.session;
    state.quality = static_cast<std::uint8_t>(message.quality);
    state.safety_state = static_cast<std::uint8_t>(message.safety);
    state.period_s = 1e-3 * message.send_period_ms;
    state.has_ipo = message.q_ipo.has_value();
    if (message.q_meas) state.q_meas = *message.q_meas;
    if (message.q_ipo) state.q_ipo = *message.q_ipo;
    if (message.tau_ext) state.tau_ext = *message.tau_ext;
  }
  PutCounters(state);
  return result;
}

FriAccept FriSession::CheckSequence(const MonitoringMessage& message) OSTEON_RT {
  // The difference modulo 2^32, read as signed, is right across the counter's wrap.
  const auto step = static_cast<std::int32_t>(message.sequence - last_.sequence);
  const bool restarted = step <= -kWindow && message.session <= SessionState::kMonitoringReady;
  if (!has_last_ || restarted) {
    seen_ = 1;
    due_ = 1;
    held_.reset();  // sent to another arm, or to this one before it moved by itself
    return FriAccept::kAccepted;
  }
  if (step > 0) {
    const auto ahead = static_cast<std::uint32_t>(step);
    seen_ = step < kWindow ? (seen_ << ahead) | 1u : 1u;
    counters_.lost += ahead - 1;
    due_ += ahead;
    return FriAccept::kAccepted;
  }
  if (step > -kWindow) {
    const std::uint64_t bit = std::uint64_t{1} << -step;
    if (seen_ & bit) {
      ++counters_.duplicate;
      return FriAccept::kDuplicate;
    }
    seen_ |= bit;
    if (counters_.lost > 0) --counters_.lost;
  }
  ++counters_.late;
  return FriAccept::kLate;
}

std::span<const std::uint8_t> FriSession::Answer(const control::ArmCommand& command) OSTEON_RT {
  if (!pending_ || last_.session == SessionState::kIdle || due_ < last_.receive_multiplier) return {};

  CommandMessage answer{.sequence = command_sequence_, .reflected_sequence = last_.sequence};
  switch (last_.session) {
    case SessionState::kCommandingActive:
      answer.q = IsFinite(command.q) ? command.q : held_.value_or(*last_.q_ipo);
      break;
    case SessionState::kCommandingWait:
      answer.q = last_.q_ipo;
      break;
    default:
      answer.q = last_.q_cmd;
      break;
  }
  if (last_.session >= SessionState::kCommandingWait) {
    if (last_.command_mode == FriCommandMode::kWrench) answer.wire_wrench.emplace();
    if (last_.command_mode == FriCommandMode::kTorque) answer.tau.emplace();
  }

  std::size_t size = 0;
  if (EncodeCommand(answer, buffer_, size) != CodecError::kNone) return {};
  held_ = answer.q;
  pending_ = false;
  due_ = 0;
  ++command_sequence_;
  return {buffer_.data(), size};
}

void FriSession::CountSuperseded(control::ArmState& state) OSTEON_RT {
  ++counters_.late;
  PutCounters(state);
}

void FriSession::CountRejected(control::ArmState& state) OSTEON_RT {
  ++counters_.rejected;
  PutCounters(state);
}

void FriSession::StartOver() OSTEON_RT { has_last_ = pending_ = false; }

void FriSession::PutCounters(control::ArmState& state) const OSTEON_RT {
  state.lost = counters_.lost;
  state.duplicate = counters_.duplicate;
  state.late = counters_.late;
  state.rejected = counters_.rejected;
}

}  // namespace osteon::io
