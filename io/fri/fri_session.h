#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "control/ports.h"
#include "io/fri/codec.h"

namespace osteon::io {

/// What became of a datagram.
enum class FriAccept : std::uint8_t {
  kAccepted,   ///< newer than all before: the state is its content
  kDuplicate,  ///< seen before
  kLate,       ///< overtaken by a newer one
  kRejected,   ///< not a valid message; last_error() says why
};

/// The client's side of an FRI 1.15 session, all of it but the socket: wall time drives it through FriLink,
/// virtual time through memory.
///
/// Sequence counters are compared modulo 2^32. A gap counts as lost until the missing message comes late
/// after all; the last 64 counters are remembered to tell late ones from duplicates. A counter further back
/// than that belongs to a new session of the arm, and is believed where the message says MONITORING or IDLE:
/// sessions begin there.
///
/// What the client owes, by session state:
///
///     IDLE                nothing
///     MONITORING_*        the arm's commanded position, mirrored (the header alone where the arm sent none)
///     COMMANDING_WAIT     the arm's interpolator position, mirrored
///     COMMANDING_ACTIVE   the loop's position
///
/// in answer to every receiveMultiplier-th message. Where the arm asks for a wrench or torque as well, a zero
/// one goes along: its absence would end the session. A command that is not finite is never sent: the last
/// position is held. Allocation-free; one thread at a time.
class FriSession {
 public:
  /// Takes a datagram that arrived at `stamp`. The counters of `state` are always set, the rest on kAccepted
  /// only.
  FriAccept Accept(std::span<const std::uint8_t> datagram, rt::Nanoseconds stamp,
                   control::ArmState& state) OSTEON_RT;

  /// The datagram that answers the message last accepted; empty where none is owed (yet), or it was answered
  /// before. Valid until the next call.
  [[nodiscard]] std::span<const std::uint8_t> Answer(const control::ArmCommand& command) OSTEON_RT;

  /// The message accepted before the last was never looked at: a newer one was already waiting behind it.
  void CountSuperseded(control::ArmState& state) OSTEON_RT;
  /// A datagram was refused before it came here, e.g. for its sender.
  void CountRejected(control::ArmState& state) OSTEON_RT;

  /// The next message begins a session, whatever its counter; the counts of ArmState go on.
  void StartOver() OSTEON_RT;

  /// Why the last kRejected datagram was refused.
  [[nodiscard]] CodecError last_error() const OSTEON_RT { return last_error_; }

 private:
  FriAccept CheckSequence(const MonitoringMessage& message) OSTEON_RT;
  void PutCounters(control::ArmState& state) const OSTEON_RT;

  struct Counters {
    std::uint32_t lost{0}, duplicate{0}, late{0}, rejected{0};
  };

  MonitoringMessage last_;
  bool has_last_{false};
  std::uint64_t seen_{0};  // bit i: counter last_.sequence - i has arrived
  std::uint32_t due_{0};   // messages of the arm since our last answer, lost ones included
  bool pending_{false};    // last_ is not answered yet
  std::uint32_t command_sequence_{0};
  std::optional<control::JointArray> held_;  // what was last sent in this session
  Counters counters_;
  CodecError last_error_{CodecError::kNone};
  std::array<std::uint8_t, kFriMaxDatagram> buffer_{};
};

}  // namespace osteon::io
