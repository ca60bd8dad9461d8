#include "io/fri/fri_relay.h"

#include <poll.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>

namespace osteon::io {
namespace {

constexpr std::size_t kMaxAtOnce = 64;  // largest number of datagrams read in one call, so that the call
                                        // returns even if datagrams keep arriving

// Converts an FRI session state to the guard's enumeration.
safety::GuardSession SessionOf(control::SessionState state) {
  switch (state) {
    case control::SessionState::kIdle:
      return safety::GuardSession::kIdle;
    case control::SessionState::kMonitoringWait:
    case control::SessionState::kMonitoringReady:
      return safety::GuardSession::kMonitoring;
    case control::SessionState::kCommandingWait:
      return safety::GuardSession::kWaiting;
    case control::SessionState::kCommandingActive:
      break;
  }
  return safety::GuardSession::kActive;
}

}  // namespace

// Protocol interface for UdpPeer that relays each valid message of the arm to the controller.
struct FriRelay::Judge {
  FriRelay& relay;

  bool Accept(std::span<const std::uint8_t> datagram, rt::Nanoseconds arrival) OSTEON_RT {
    return relay.RelayMessage(datagram, arrival);
  }
  [[nodiscard]] bool IsMessage(std::span<const std::uint8_t> datagram) const OSTEON_RT {
    return IsMonitoringMessage(relay.family_, datagram);
  }
  void Reject() OSTEON_RT { ++relay.counters_.rejected; }
  void ResetSession() OSTEON_RT { relay.monitor_.ResetSession(); }
  // nothing to do: an overtaken message was relayed too, and the controller counts it
  void OnOvertaken() OSTEON_RT {}
};

tl::expected<std::unique_ptr<FriRelay>, std::string> FriRelay::Open(const FriRelayParams& params,
                                                                    safety::GuardMonitor& monitor) {
  const auto from = PeerAddress("guard: the arm's", params.arm_host);
  if (!from) return tl::unexpected(from.error());
  const auto to = Ipv4("guard: the controller's", params.controller_address, params.controller_port);
  if (!to) return tl::unexpected(to.error());
  const std::string place =
      "guard: UDP to " + params.controller_address + ":" + std::to_string(params.controller_port);
  const int controller = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (controller < 0) return tl::unexpected(place + ": no socket: " + SystemReason(errno));
  const int on = 1;
  (void)setsockopt(controller, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on);
  if (connect(controller, reinterpret_cast<const sockaddr*>(&*to), sizeof *to) != 0) {
    const std::string reason = SystemReason(errno);
    close(controller);
    return tl::unexpected(place + ": no way there: " + reason);
  }
  const auto arm = BindUdp("guard", params.arm_address, params.arm_port);
  if (!arm) {
    close(controller);
    return tl::unexpected(arm.error());
  }
  return std::unique_ptr<FriRelay>(new FriRelay(*arm, *from, controller, FamilyOf(params.version), monitor));
}

FriRelay::~FriRelay() { close(controller_); }

bool FriRelay::Serve(rt::Nanoseconds deadline) OSTEON_RT {
  for (;;) {
    if (!ReceiveAnswers()) return false;
    if (arm_.Receive(Judge{*this}, 0) == control::ReceiveResult::kClosed) return false;
    const rt::Nanoseconds now = rt::MonotonicNow();
    monitor_.CheckSilence(now);
    if (now >= deadline) return true;
    const rt::Nanoseconds left = deadline - now;
    const timespec wait{.tv_sec = left / rt::kSecond, .tv_nsec = left % rt::kSecond};
    std::array<pollfd, 2> sockets{pollfd{.fd = arm_.socket(), .events = POLLIN, .revents = 0},
                                  pollfd{.fd = controller_, .events = POLLIN, .revents = 0}};
    if (ppoll(sockets.data(), sockets.size(), &wait, nullptr) < 0 && errno != EINTR) return false;
  }
}

bool FriRelay::RelayMessage(std::span<const std::uint8_t> datagram, rt::Nanoseconds arrival) OSTEON_RT {
  if (DecodeMonitoring(family_, datagram, message_) != CodecError::kNone) {
    ++counters_.rejected;
    return false;
  }
  const safety::GuardArmMessage seen{.sequence = message_.sequence,
                                     .session = SessionOf(message_.session),
                                     .q_meas = message_.q_meas.value_or(safety::GuardJoints{}),
                                     .q_ipo = message_.q_ipo,
                                     .tau_ext = message_.tau_ext,
                                     .compliant = message_.command_mode == control::CommandMode::kWrench ||
                                                  message_.command_mode == control::CommandMode::kTorque};
  if (monitor_.OnArmMessage(seen, arrival) != safety::GuardDecision::kPass) return true;
  if (send(controller_, datagram.data(), datagram.size(), MSG_DONTWAIT | MSG_NOSIGNAL) !=
      static_cast<ssize_t>(datagram.size())) {
    ++counters_.undelivered;
    return true;
  }
  ++counters_.to_controller;
  message_delay_.Add(rt::MonotonicNow() - arrival);
  return true;
}

bool FriRelay::ReceiveAnswers() OSTEON_RT {
  for (std::size_t left = kMaxAtOnce; left > 0; --left) {
    const Datagram answer = ReadDatagram(controller_, answer_buffer_);
    if (answer.read == Datagram::Read::kNone) return true;
    if (answer.read == Datagram::Read::kGone) return false;
    if (answer.read == Datagram::Read::kTaken) RelayAnswer(answer.bytes, answer.arrival);
  }
  return true;
}

void FriRelay::RelayAnswer(std::span<const std::uint8_t> datagram, rt::Nanoseconds arrival) OSTEON_RT {
  FriReadCommand command;
  switch (ReadCommand(family_, datagram, command)) {
    case FriCommandError::kNone:
      break;
    case FriCommandError::kChecksum:
      (void)monitor_.OnUnreadable(safety::GuardFinding::kChecksum);
      return;
    case FriCommandError::kMalformed:
      (void)monitor_.OnUnreadable(safety::GuardFinding::kUnreadable);
      return;
  }
  const safety::GuardCommand seen{.sequence = command.sequence,
                                  .reflected = command.reflected_sequence,
                                  .q = command.q,
                                  .wrench = command.wrench,
                                  .tau = command.tau,
                                  .cartesian = command.cartesian};
  if (monitor_.OnCommand(seen, rt::MonotonicNow()) != safety::GuardDecision::kPass) return;
  if (!arm_.Send(datagram)) {
    ++counters_.undelivered;
    return;
  }
  ++counters_.to_arm;
  answer_delay_.Add(rt::MonotonicNow() - arrival);
}

}  // namespace osteon::io
