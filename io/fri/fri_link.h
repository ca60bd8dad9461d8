#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <tl/expected.hpp>

#include "control/ports.h"
#include "io/fri/fri_session.h"
#include "io/net/cache_warmup.h"
#include "io/net/udp_peer.h"

namespace osteon::io {

struct FriLinkParams {
  std::string bind_address{"127.0.0.1"};  ///< IPv4 address of the network card that the arm is on
  /// IPv4; datagrams from others are rejected. Empty: the first valid sender is the arm.
  std::string arm_address{};
  std::uint16_t port{30200};  ///< 30200 … 30209 on KUKA's side, one for each arm; 0 lets the system choose
  FriSessionParams session{};
};

/// FRI over UDP. The arm speaks first; answers go to the source of its message. The first sender of a valid
/// message is the peer. Others are counted as rejected, until the peer has been silent for a second (a
/// restarted arm may come back from another port). If several messages wait, the newest is used and the
/// others count as late.
///
/// ArmState::stamp is the arrival in the kernel if the system provides it (SO_TIMESTAMPNS, converted to
/// CLOCK_MONOTONIC), so that the loop can see its own wake-up latency; otherwise the time of reading. One
/// thread at a time; no allocation, no system calls except the socket's and the clock's.
class FriLink final : public control::ArmLink {
 public:
  /// The error names address and port, and says what to do.
  [[nodiscard]] static tl::expected<std::unique_ptr<FriLink>, std::string> Open(const FriLinkParams& params);

  /// `deadline` is on CLOCK_MONOTONIC; messages that have arrived are taken even if it has passed.
  control::ReceiveResult Receive(control::ArmState& state, rt::Nanoseconds deadline) OSTEON_RT override;

  /// Also true if the session state owes no answer.
  bool Send(const control::ArmCommand& command) OSTEON_RT override;

  bool Await(rt::Nanoseconds time) OSTEON_RT override { return peer_.Await(time); }
  void WarmUp(const control::ArmCommand& command) OSTEON_RT override;

  /// The bound port.
  [[nodiscard]] std::uint16_t port() const { return peer_.port(); }

  /// The session: the arm's last message in full, and what keeps the arm from being commanded. For the link's
  /// thread only.
  [[nodiscard]] FriSession& session() { return session_; }
  [[nodiscard]] const FriSession& session() const { return session_; }

 private:
  static constexpr std::size_t kRoom = kFriMaxDatagram + 1;  // one more, to detect oversized datagrams

  FriLink(const BoundUdp& bound, std::optional<in_addr> arm, const FriLinkParams& params)
      : peer_(bound, arm),
        session_(params.session),
        warmup_(CacheWarmup<FriSession, kRoom>::Make("cache warm-up", session_)) {}

  UdpPeer<kRoom> peer_;
  FriSession session_;
  std::unique_ptr<CacheWarmup<FriSession, kRoom>> warmup_;
};

}  // namespace osteon::io
