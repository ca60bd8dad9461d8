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
  std::string bind_address{"127.0.0.1"};  ///< IPv4 address of the network card to which the arm is connected
  /// IPv4 address of the arm; datagrams from other addresses are rejected. Empty: the first sender of a valid
  /// message is the arm.
  std::string arm_address{};
  std::uint16_t port{30200};  ///< 30200 … 30209 on KUKA arms, one for each arm; 0: the system chooses a port
  FriSessionParams session{};
};

/// Connection to an arm by FRI over UDP. The arm sends first; answers go to the source of the arm's message.
/// The first sender of a valid message is the peer. Datagrams of other senders are counted as rejected until
/// the peer has been silent for a second (a restarted arm may use another port). If several messages wait,
/// the newest is used and the others are counted as late.
///
/// ArmState::stamp is the time of arrival in the kernel if the system provides it (SO_TIMESTAMPNS, converted
/// to CLOCK_MONOTONIC), so that the loop can measure its wake-up latency. Otherwise it is the time of
/// reading. One thread at a time; no allocation, no system calls except the socket's and the clock's.
class FriLink final : public control::ArmLink {
 public:
  /// The error names address and port, and says what to do.
  [[nodiscard]] static tl::expected<std::unique_ptr<FriLink>, std::string> Open(const FriLinkParams& params);

  /// `deadline` is on CLOCK_MONOTONIC; messages that have already arrived are returned even if the deadline
  /// has passed.
  control::ReceiveResult Receive(control::ArmState& state, rt::Nanoseconds deadline) OSTEON_RT override;

  /// Sends the answer to the last message. Also returns true if no answer is due in the session state.
  bool Send(const control::ArmCommand& command) OSTEON_RT override;

  bool Await(rt::Nanoseconds time) OSTEON_RT override { return peer_.Await(time); }
  void WarmUp(const control::ArmCommand& command) OSTEON_RT override;

  /// The local port.
  [[nodiscard]] std::uint16_t port() const { return peer_.port(); }

  /// The session, which gives the arm's last message in full and the reason why the arm cannot be commanded.
  /// To be used by the link's thread only.
  [[nodiscard]] FriSession& session() { return session_; }
  [[nodiscard]] const FriSession& session() const { return session_; }

 private:
  // one byte more than FRI's maximum, to detect oversized datagrams
  static constexpr std::size_t kRoom = kFriMaxDatagram + 1;

  FriLink(const BoundUdp& bound, std::optional<in_addr> arm, const FriLinkParams& params)
      : peer_(bound, arm),
        session_(params.session),
        warmup_(CacheWarmup<FriSession, kRoom>::Make("cache warm-up", session_)) {}

  UdpPeer<kRoom> peer_;
  FriSession session_;
  std::unique_ptr<CacheWarmup<FriSession, kRoom>> warmup_;
};

}  // namespace osteon::io
