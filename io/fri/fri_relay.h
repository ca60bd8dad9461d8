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
  std::string arm_address{"127.0.0.1"};  ///< IPv4 address of the network card to which the arm is connected
  std::uint16_t arm_port{30209};         ///< local port to which the arm sends; 0: any free port
  std::string arm_host{};  ///< IPv4 address of the arm; other senders are rejected. Empty: the first sender
                           ///< of a valid message is the arm
  std::string controller_address{"127.0.0.1"};
  std::uint16_t controller_port{30200};  ///< port on which the controller waits for the arm
  FriVersion version{FriVersion::k1_15};
};

struct FriRelayCounters {
  std::uint64_t to_controller{0}, to_arm{0};  ///< messages relayed
  /// Datagrams at arm_port that were not from the arm, or no message of this version.
  std::uint64_t rejected{0};
  std::uint64_t undelivered{0};  ///< messages that the system did not accept for sending, or for which nobody
                                 ///< listens at the receiver's port
};

/// Relays an FRI session's datagrams between arm and controller, unchanged, if a GuardMonitor permits it. An
/// arm communicates with one FRI peer only, so a supervisor must be placed between arm and controller.
///
///     messages: arm ──▶ arm_port ──▶ monitor ──▶ (local port) ──▶ controller_port
///     answers:  arm ◀── arm_port ◀── monitor ◀── (local port) ◀── controller_port
///
/// The first sender of a valid message is the arm, as in FriLink. On the controller's side, only datagrams
/// from the controller's address and port are read. If answers and messages wait, answers are relayed first,
/// so that an answer that arrived in time does not become late if this process wakes up late. One thread at a
/// time; no allocation after opening.
class FriRelay {
 public:
  /// `monitor` must outlive the relay. The error names address and port, and says what to do.
  [[nodiscard]] static tl::expected<std::unique_ptr<FriRelay>, std::string> Open(
      const FriRelayParams& params, safety::GuardMonitor& monitor);
  ~FriRelay();
  FriRelay(const FriRelay&) = delete;
  FriRelay& operator=(const FriRelay&) = delete;

  /// Relays waiting datagrams and those that arrive until `deadline` on CLOCK_MONOTONIC. After each wait, the
  /// monitor checks how long the controller has been silent. Returns false if a socket has failed.
  bool Serve(rt::Nanoseconds deadline) OSTEON_RT;

  [[nodiscard]] std::uint16_t port() const { return arm_.port(); }
  [[nodiscard]] const FriRelayCounters& counters() const { return counters_; }
  /// Delays of the relayed messages: from a datagram's arrival in this machine's kernel until the system has
  /// accepted it for sending.
  [[nodiscard]] const rt::DurationHistogram& message_delay() const { return message_delay_; }
  [[nodiscard]] const rt::DurationHistogram& answer_delay() const { return answer_delay_; }

 private:
  FriRelay(const BoundUdp& arm, std::optional<in_addr> from, int controller, FriFamily family,
           safety::GuardMonitor& monitor)
      : arm_(arm, from), controller_(controller), family_(family), monitor_(monitor) {}

  // Passes the arm's message to the monitor, and sends it to the controller if the monitor permits it.
  // Returns false if the message cannot be decoded.
  bool RelayMessage(std::span<const std::uint8_t> datagram, rt::Nanoseconds arrival) OSTEON_RT;
  // Relays the controller's waiting answers. Returns false if the socket has failed.
  bool ReceiveAnswers() OSTEON_RT;
  // Passes the controller's answer to the monitor, and sends it to the arm if the monitor permits it.
  void RelayAnswer(std::span<const std::uint8_t> datagram, rt::Nanoseconds arrival) OSTEON_RT;

  struct Judge;  // tells UdpPeer whether a datagram is a message of the arm, and relays it

  UdpPeer<kFriMaxDatagram + 1> arm_;  // one byte more than FRI's maximum, to detect oversized datagrams
  int controller_;  // socket that is connected to the controller, so it receives from the controller only
  FriFamily family_;
  safety::GuardMonitor& monitor_;
  MonitoringMessage message_;
  std::array<std::uint8_t, kFriMaxDatagram + 1> answer_buffer_{};
  FriRelayCounters counters_;
  rt::DurationHistogram message_delay_, answer_delay_;
};

}  // namespace osteon::io
