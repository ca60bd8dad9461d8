#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <tl/expected.hpp>

#include "base/duration_histogram.h"
#include "io/fri/codec.h"
#include "io/fri/command_reader.h"
#include "io/net/udp_peer.h"
#include "safety/guard_monitor.h"

namespace osteon::io {

struct FriRelayParams {
  std::string arm_address{"127.0.0.1"};  ///< IPv4 address of the network card that the arm is on
  std::uint16_t arm_port{30209};         ///< port that the arm sends to; 0: any free one
  std::string arm_host{};  ///< IPv4 of the arm; others are rejected. Empty: the first valid sender is the arm
  std::string controller_address{"127.0.0.1"};
  std::uint16_t controller_port{30200};  ///< where the controller waits for the arm
  FriVersion version{FriVersion::k1_15};
};

struct FriRelayCounters {
  std::uint64_t to_controller{0}, to_arm{0};  ///< messages relayed
  std::uint64_t rejected{0};  ///< came to arm_port, but not from the arm, or not as a message of this version
  std::uint64_t undelivered{0};  ///< the system did not accept them, or nobody listens at the receiver's port
};

/// Relays an FRI session's datagrams between arm and controller, unchanged, if a GuardMonitor lets them pass.
/// An arm speaks to one FRI peer only, so a supervisor must stand between the two.
///
///     messages: arm ──▶ arm_port ──▶ monitor ──▶ (a port of ours) ──▶ controller_port
///     answers:  arm ◀── arm_port ◀── monitor ◀── (that port) ◀── controller_port
///
/// The arm is the first sender of a valid message, as for FriLink; on the other side only datagrams from the
/// controller's address and port are read. If both wait, answers are relayed before messages: if this
/// process wakes up late, an answer that came in time must not count as late. One thread at a time; no
/// allocation after opening.
class FriRelay {
 public:
  /// `monitor` must outlive the relay. The error names address and port, and says what to do.
  [[nodiscard]] static tl::expected<std::unique_ptr<FriRelay>, std::string> Open(
      const FriRelayParams& params, safety::GuardMonitor& monitor);
  ~FriRelay();
  FriRelay(const FriRelay&) = delete;
  FriRelay& operator=(const FriRelay&) = delete;

  /// Relays waiting datagrams and those that come until `deadline` on CLOCK_MONOTONIC. After each wait, the
  /// monitor checks how long the controller has been silent. False if a socket has failed.
  bool Serve(rt::Nanoseconds deadline) OSTEON_RT;

  [[nodiscard]] std::uint16_t port() const { return arm_.port(); }
  [[nodiscard]] const FriRelayCounters& counters() const { return counters_; }
  /// From a datagram's arrival in this machine's kernel until the system has accepted it for sending.
  [[nodiscard]] const rt::DurationHistogram& message_delay() const { return message_delay_; }
  [[nodiscard]] const rt::DurationHistogram& answer_delay() const { return answer_delay_; }

 private:
  FriRelay(const BoundUdp& arm, std::optional<in_addr> from, int controller, FriFamily family,
           safety::GuardMonitor& monitor)
      : arm_(arm, from), controller_(controller), family_(family), monitor_(monitor) {}

  // Shows the arm's message to the monitor, and sends it to the controller if it may pass. False if it cannot
  // be read.
  bool RelayMessage(std::span<const std::uint8_t> datagram, rt::Nanoseconds arrival) OSTEON_RT;
  // Relays the controller's waiting answers. False if the socket is gone.
  bool ReceiveAnswers() OSTEON_RT;
  // Shows the controller's answer to the monitor, and sends it to the arm if it may pass.
  void RelayAnswer(std::span<const std::uint8_t> datagram, rt::Nanoseconds arrival) OSTEON_RT;

  struct Judge;  // tells UdpPeer whether a datagram is a message of the arm, and relays it

  UdpPeer<kFriMaxDatagram + 1> arm_;  // one more, to detect oversized datagrams
  int controller_;                    // connected, so nobody else is heard
  FriFamily family_;
  safety::GuardMonitor& monitor_;
  MonitoringMessage message_;
  std::array<std::uint8_t, kFriMaxDatagram + 1> answer_buffer_{};
  FriRelayCounters counters_;
  rt::DurationHistogram message_delay_, answer_delay_;
};

}  // namespace osteon::io
