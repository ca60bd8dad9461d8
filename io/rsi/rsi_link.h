#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <tl/expected.hpp>

#include "control/ports.h"
#include "io/net/cache_warmup.h"
#include "io/net/udp_peer.h"
#include "io/rsi/rsi_session.h"

namespace osteon::io {

struct RsiLinkParams {
  std::string bind_address{"127.0.0.1"};  ///< IPv4 address of the network card that the controller is on
  /// IPv4; datagrams from others are rejected. Empty: the first valid sender is the arm.
  std::string arm_address{};
  std::uint16_t port{49152};  ///< as in the controller's Ethernet configuration; 0: any free one
  RsiSessionParams session{};
};

/// RSI over UDP. This side is the server: the controller sends first, and each answer goes to the address
/// that its message came from. The first sender of a valid message becomes the peer. Messages of other
/// senders are counted as rejected, until the peer has been silent for a second. If several messages wait,
/// the newest is used and the others count as late.
///
/// ArmState::stamp is the arrival in the kernel if the system provides it, otherwise the time of reading. One
/// thread at a time; no allocation, no system calls except the socket's and the clock's.
class RsiLink final : public control::ArmLink {
 public:
  /// Opens the socket. The error names address and port, or the invalid parameter of the session, and says
  /// what to do.
  [[nodiscard]] static tl::expected<std::unique_ptr<RsiLink>, std::string> Open(const RsiLinkParams& params);

  /// Waits for a message until `deadline` on CLOCK_MONOTONIC. Messages that have already arrived are read
  /// even if the deadline has passed.
  control::ReceiveResult Receive(control::ArmState& state, rt::Nanoseconds deadline) OSTEON_RT override;

  /// Sends the answer to the last accepted message. Returns true also if there is no message to answer.
  bool Send(const control::ArmCommand& command) OSTEON_RT override;

  bool Await(rt::Nanoseconds time) OSTEON_RT override { return peer_.Await(time); }
  void WarmUp(const control::ArmCommand& command) OSTEON_RT override;

  /// See RsiSession::RequestStop.
  void RequestStop() OSTEON_RT { session_.RequestStop(); }

  [[nodiscard]] const RsiStatus& status() const OSTEON_RT { return session_.status(); }
  [[nodiscard]] const RsiError& last_error() const OSTEON_RT { return session_.last_error(); }
  /// The bound port.
  [[nodiscard]] std::uint16_t port() const { return peer_.port(); }

 private:
  static constexpr std::size_t kRoom = kRsiMaxDatagram + 1;  // one byte more, to detect oversized datagrams

  RsiLink(const BoundUdp& bound, std::optional<in_addr> arm, const RsiLinkParams& params)
      : peer_(bound, arm),
        session_(params.session),
        warmup_(CacheWarmup<RsiSession, kRoom>::Make("cache warm-up", session_)) {}

  UdpPeer<kRoom> peer_;
  RsiSession session_;
  std::unique_ptr<CacheWarmup<RsiSession, kRoom>> warmup_;
};

}  // namespace osteon::io
