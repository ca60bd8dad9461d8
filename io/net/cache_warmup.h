#pragma once

#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>

#include "control/ports.h"
#include "io/net/udp_peer.h"

namespace osteon::io {

/// Keeps the code and data of the message path in the processor's caches. Shortly before the next message is
/// expected, it sends the last message through the kernel's loopback interface, decodes it, and encodes and
/// sends an answer. It uses two sockets and a session of its own, whose results are discarded. The session
/// has the same state as the link's session if every message that the link has accepted is passed to Run.
/// @tparam Session  the protocol's session, FRI or RSI (see SessionJudge)
template <class Session, std::size_t kMaxBytes>
class CacheWarmup {
 public:
  /// Opens the two sockets. Returns null if the system provides no sockets; the caller then runs without a
  /// warm-up.
  [[nodiscard]] static std::unique_ptr<CacheWarmup> Make(const char* who, const Session& session) {
    const auto near = BindUdp(who, kLoopback, 0);
    if (!near) return nullptr;
    const auto far = BindUdp(who, kLoopback, 0);
    if (!far) {
      close(near->socket);
      return nullptr;
    }
    auto made = std::unique_ptr<CacheWarmup>(new CacheWarmup(*near, *far, session));
    // connect the sockets to each other, so that the system drops datagrams of other senders
    return ConnectTo(far->port, near->socket) && ConnectTo(near->port, far->socket) ? std::move(made)
                                                                                    : nullptr;
  }
  ~CacheWarmup() { close(far_.socket); }
  CacheWarmup(const CacheWarmup&) = delete;
  CacheWarmup& operator=(const CacheWarmup&) = delete;

  /// Runs through the message path once. @param message  the link's last accepted message; empty: does
  /// nothing
  void Run(std::span<const std::uint8_t> message, const control::ArmCommand& command) OSTEON_RT {
    if (message.empty()) return;
    (void)send(far_.socket, message.data(), message.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    if (near_.Receive(SessionJudge{session_, state_}, 0) != control::ReceiveResult::kOk) return;
    const std::span<const std::uint8_t> answer = session_.Answer(command);
    if (answer.empty() || !near_.Send(answer)) return;
    (void)ReadDatagram(far_.socket, buffer_);
  }

 private:
  static constexpr const char* kLoopback = "127.0.0.1";

  static bool ConnectTo(std::uint16_t port, int socket) {
    const auto peer = Ipv4("cache warm-up", kLoopback, port);
    return peer && connect(socket, reinterpret_cast<const sockaddr*>(&*peer), sizeof *peer) == 0;
  }

  CacheWarmup(const BoundUdp& near, const BoundUdp& far, const Session& session)
      : near_(near), far_(far), session_(session) {}

  UdpPeer<kMaxBytes> near_;  // plays the role of the link
  BoundUdp far_;             // plays the role of the arm
  Session session_;
  control::ArmState state_;
  std::array<std::uint8_t, kMaxBytes> buffer_{};
};

}  // namespace osteon::io
