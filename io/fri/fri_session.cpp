#include "io/fri/fri_session.h"

#include <algorithm>
#include <cmath>

namespace osteon::io {
namespace {

using control::CommandMode;
using control::JointArray;
using control::SessionState;

constexpr std::int32_t kWindow = 64;  // number of the newest message counters of the arm that seen_ stores

bool IsFinite(const JointArray& q) OSTEON_RT {
  return std::all_of(q.begin(), q.end(), [](double joint) { return std::isfinite(joint); });
}

bool IsFinite(const PlainWrench& F) OSTEON_RT { return Vector3(F.f).allFinite() && Vector3(F.t).allFinite(); }

// Whether each joint of a differs from that of b by at most bound_rad; false for NaN.
bool AreClose(const JointArray& a, const JointArray& b, double bound_rad) OSTEON_RT {
  for (std::size_t i = 0; i < a.size(); ++i)
    if (!(std::abs(a[i] - b[i]) <= bound_rad)) return false;
  return true;
}

// Converts a wrench to the order of the wire: force [N], then torques [N·m].
std::array<double, 6> ToWire(const PlainWrench& F, FriTorqueOrder order) OSTEON_RT {
  if (order == FriTorqueOrder::kXyz) return {F.f.x, F.f.y, F.f.z, F.t.x, F.t.y, F.t.z};
  return {F.f.x, F.f.y, F.f.z, F.t.z, F.t.y, F.t.x};
}

}  // namespace

FriAccept FriSession::Accept(std::span<const std::uint8_t> datagram, rt::Nanoseconds stamp,
                             control::ArmState& state) OSTEON_RT {
  MonitoringMessage message;
  FriAccept result = FriAccept::kRejected;
  const CodecError error = DecodeMonitoring(family_, datagram, message);
  if (error != CodecError::kNone) {
    last_error_ = error;
    ++counters_.rejected;
    if (error == CodecError::kOtherVersion) {
      ++counters_.other_version;
      other_family_ = DetectFamily(datagram);
    }
    // If the arm reports a joint that is not finite, the loop must get the joints, so that it can name the
    // joint and stop.
    if (const auto q = has_last_ && error == CodecError::kNotFinite ? JointsNotFinite(family_, datagram)
                                                                    : std::nullopt) {
      state.stamp = stamp;
      state.q_meas = *q;
      PutCounters(state);
      return FriAccept::kAccepted;
    }
  } else {
    result = CheckSequence(message);
  }

  if (result == FriAccept::kAccepted) {
    CheckReflected(message);
    CheckActivation(message);
    if (has_last_ && message.session != last_.session) session_before_ = last_.session;
    last_ = message;
    has_last_ = pending_ = true;
    state.stamp = stamp;
    state.sequence = message.sequence;
    state.session = message.session;
    state.quality = static_cast<std::uint8_t>(message.quality);
    state.safety_state = static_cast<std::uint8_t>(message.safety);
    state.operation_mode = static_cast<std::uint8_t>(message.operation);
    state.drives_active = std::all_of(message.drives.begin(), message.drives.end(),
                                      [](FriDriveState drive) { return drive == FriDriveState::kActive; });
    state.control_mode = message.control;
    state.command_mode = message.command_mode;
    state.period_s = 1e-3 * message.send_period_ms;
    state.has_ipo = message.q_ipo.has_value();
    state.activation = activation_;
    state.holding = holding_;
    if (message.q_meas) state.q_meas = *message.q_meas;
    if (message.q_ipo) state.q_ipo = *message.q_ipo;
    if (message.tau_ext) state.tau_ext = *message.tau_ext;
  }
  PutCounters(state);
  return result;
}

bool FriSession::IsMessage(std::span<const std::uint8_t> datagram) const OSTEON_RT {
  return IsMonitoringMessage(family_, datagram);
}

FriAccept FriSession::CheckSequence(const MonitoringMessage& message) OSTEON_RT {
  // The counters' difference modulo 2^32, interpreted as a signed number, is also correct if the counter has
  // wrapped.
  const auto step = static_cast<std::int32_t>(message.sequence - last_.sequence);
  const bool restarted = step <= -kWindow && message.session <= SessionState::kMonitoringReady;
  if (!has_last_ || restarted) {
    seen_ = 1;
    due_ = 1;
    BeginSession();
    return FriAccept::kAccepted;
  }
  if (step > 0) {  // newer than all earlier messages
    const auto ahead = static_cast<std::uint32_t>(step);
    seen_ = step < kWindow ? (seen_ << ahead) | 1u : 1u;
    counters_.lost += ahead - 1;
    due_ += ahead;
    if (step >= kWindow) active_ = false;  // the arm may have left COMMANDING_ACTIVE and returned unnoticed
    return FriAccept::kAccepted;
  }
  if (step > -kWindow) {  // older, and still stored in seen_
    const std::uint64_t bit = std::uint64_t{1} << -step;
    if (seen_ & bit) {
      ++counters_.duplicate;
      return FriAccept::kDuplicate;
    }
    seen_ |= bit;
    if (counters_.lost > 0) --counters_.lost;
  }
  ++counters_.reordered;
  return FriAccept::kReordered;
}

void FriSession::BeginSession() OSTEON_RT {
  held_.reset();  // the position belongs to the earlier session; the arm may have moved since
  first_answer_ = command_sequence_;
  any_reflected_ = active_ = false;
}

// The arm reflects the sequence number of the newest answer that it has received.
void FriSession::CheckReflected(const MonitoringMessage& message) OSTEON_RT {
  // index of the reflected answer among this session's answers, from 0
  const std::uint32_t index = message.reflected_sequence - first_answer_;
  // The reflected answer is not of this session: the arm has received no answer yet, or an answer of another
  // client.
  if (index >= command_sequence_ - first_answer_) {
    if (any_reflected_) ++counters_.answers_foreign;
    return;
  }
  const std::uint32_t step = any_reflected_ ? message.reflected_sequence - reflected_ : index + 1;
  if (step > index + 1) {  // older than the answer that was reflected before
    ++counters_.answers_foreign;
    return;
  }
  if (step > 0) counters_.answers_lost += step - 1;
  any_reflected_ = true;
  reflected_ = message.reflected_sequence;
}

void FriSession::CheckActivation(const MonitoringMessage& message) OSTEON_RT {
  const bool active = message.session == SessionState::kCommandingActive;
  if (active && !active_) {
    ++activation_;
    holding_ = true;
  }
  active_ = active;
  holding_ &= active;
}

std::span<const std::uint8_t> FriSession::Answer(const control::ArmCommand& command) OSTEON_RT {
  if (!pending_ || last_.session == SessionState::kIdle || due_ < last_.receive_multiplier) return {};

  CommandMessage answer{.sequence = command_sequence_, .reflected_sequence = last_.sequence};
  PutMotion(command, answer);
  std::size_t size = 0;
  if (EncodeCommand(family_, answer, buffer_, size) != CodecError::kNone) return {};
  held_ = answer.q;
  pending_ = false;
  due_ = 0;
  ++command_sequence_;
  return {buffer_.data(), size};
}

bool FriSession::AcceptCommand(const control::ArmCommand& command) OSTEON_RT {
  if (command.activation != activation_ || !IsFinite(command.q)) return false;
  if (holding_ && !AreClose(command.q, *last_.q_ipo, params_.entry_step_rad)) return false;
  holding_ = false;
  return true;
}

void FriSession::PutMotion(const control::ArmCommand& command, CommandMessage& answer) OSTEON_RT {
  if (last_.session < SessionState::kCommandingWait) {
    if (family_ == FriFamily::k1) answer.q = last_.q_cmd;
    return;
  }
  const bool cartesian = last_.command_mode == CommandMode::kCartesianPose;
  const bool active = last_.session == SessionState::kCommandingActive && !cartesian;
  const bool follows = active && AcceptCommand(command);
  if (follows)
    answer.q = command.q;
  else
    answer.q = active && !holding_ && held_ ? held_ : last_.q_ipo;

  if (cartesian) answer.X = last_.X_ipo;
  if (last_.command_mode == CommandMode::kWrench)
    answer.wire_wrench =
        ToWire(follows && IsFinite(command.F) ? command.F : PlainWrench{}, params_.torque_order);
  if (last_.command_mode == CommandMode::kTorque)
    answer.tau = follows && IsFinite(command.tau) ? command.tau : JointArray{};
}

void FriSession::CountLate(control::ArmState& state) OSTEON_RT {
  ++counters_.late;
  PutCounters(state);
}

void FriSession::CountRejected(control::ArmState& state) OSTEON_RT {
  ++counters_.rejected;
  PutCounters(state);
}

void FriSession::ResetSession() OSTEON_RT { has_last_ = pending_ = false; }

void FriSession::PutCounters(control::ArmState& state) const OSTEON_RT {
  state.lost = counters_.lost;
  state.duplicate = counters_.duplicate;
  state.late = counters_.late;
  state.reordered = counters_.reordered;
  state.rejected = counters_.rejected;
  state.other_version = counters_.other_version;
  state.answers_lost = counters_.answers_lost;
  state.answers_foreign = counters_.answers_foreign;
}

}  // namespace osteon::io
