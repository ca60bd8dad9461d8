#pragma once

#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "control/ports.h"
#include "io/net/message_batch.h"
#include "io/net/udp_socket.h"

namespace osteon::io {

/// Adapter of a session (FriSession, RsiSession), which evaluates the arm's messages, to UdpPeer's protocol
/// interface.
template <class Session>
struct SessionJudge {
  Session& session;
  control::ArmState& state;

  bool Accept(std::span<const std::uint8_t> datagram, rt::Nanoseconds arrival) OSTEON_RT {
    const auto taken = session.Accept(datagram, arrival, state);
    return taken == decltype(taken)::kAccepted;
  }
  [[nodiscard]] bool IsMessage(std::span<const std::uint8_t> datagram) const OSTEON_RT {
    return session.IsMessage(datagram);
  }
  void Reject() OSTEON_RT { session.CountRejected(state); }
  void ResetSession() OSTEON_RT { session.ResetSession(); }
  void OnOvertaken() OSTEON_RT { session.CountLate(state); }
};
template <class Session>
SessionJudge(Session&, control::ArmState&) -> SessionJudge<Session>;

/// The PC's end of a protocol in which the other side (the peer) sends first; answers go to the source of the
/// peer's message. If the peer's address is given, messages from other addresses are rejected. The first
/// sender of a valid message is the peer. Other senders are rejected until the peer has been silent for a
/// second (a restarted peer may use another port). If several messages wait, the newest is used. One thread
/// at a time; no allocation after opening, no system calls except the socket's and the clock's.
/// @tparam kMaxBytes  largest size of a datagram; a longer one is truncated
template <std::size_t kMaxBytes>
class UdpPeer {
 public:
  /// Time without a message from the peer after which another sender may become the peer.
  static constexpr rt::Nanoseconds kSilence = rt::kSecond;

  /// @param from  the peer's address; none: any address
  explicit UdpPeer(const BoundUdp& bound, std::optional<in_addr> from = {}) : bound_(bound), from_(from) {}
  ~UdpPeer() {
    if (bound_.socket >= 0) close(bound_.socket);
  }
  UdpPeer(const UdpPeer&) = delete;
  UdpPeer& operator=(const UdpPeer&) = delete;

  [[nodiscard]] std::uint16_t port() const { return bound_.port; }
  /// The socket's descriptor, only for polling by callers that wait for several sockets.
  [[nodiscard]] int socket() const OSTEON_RT { return bound_.socket; }
  [[nodiscard]] bool has_peer() const OSTEON_RT { return has_peer_; }

  /// Waits for valid messages until `deadline` on CLOCK_MONOTONIC. Messages that have already arrived are
  /// received even if the deadline has passed. `protocol` evaluates the messages, without allocation:
  ///
  ///     bool Accept(std::span<const std::uint8_t> datagram, rt::Nanoseconds arrival)   true if it is valid
  ///     bool IsMessage(std::span<const std::uint8_t> datagram)   true if it could be valid; changes nothing
  ///     void Reject()        called for a datagram of another sender than the peer
  ///     void ResetSession()  called if the next message is from a new peer
  ///     void OnOvertaken()   called if a valid message is overtaken by a newer one that also waited
  template <class Protocol>
  control::ReceiveResult Receive(Protocol&& protocol, rt::Nanoseconds deadline) OSTEON_RT {
    constexpr std::size_t kMaxAtOnce = 64;  // largest number of datagrams read before a return or a wait
    for (;;) {
      bool received = false;
      for (std::size_t left = kMaxAtOnce; left > 0;) {
        const std::size_t asked = std::min(left, Batch::kMax);
        const int taken = in_.Receive(bound_.socket, asked);
        if (taken < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) break;
        if (taken < 0 && (errno == EBADF || errno == ENOTSOCK)) return control::ReceiveResult::kClosed;
        const std::size_t came = static_cast<std::size_t>(std::max(taken, 0));
        for (std::size_t i = 0; i < came; ++i) {
          if (!AcceptMessage(protocol, i)) continue;
          if (received) protocol.OnOvertaken();
          received = true;
        }
        if (taken > 0 && came < asked) break;  // no further message waits
        // a call without a message counts too; it reports that a datagram sent earlier was undeliverable
        left -= std::max<std::size_t>(came, 1);
      }
      if (received) return control::ReceiveResult::kOk;
      if (rt::MonotonicNow() >= deadline) return control::ReceiveResult::kTimeout;
      if (WaitReadable(bound_.socket, deadline) == Wait::kGone) return control::ReceiveResult::kClosed;
    }
  }

  /// The newest valid message. Valid until the next Receive.
  [[nodiscard]] std::span<const std::uint8_t> newest() const OSTEON_RT { return newest_; }

  /// Waits until `time` on CLOCK_MONOTONIC, or until a datagram can be read or the socket is closed. Returns
  /// true in the latter cases.
  [[nodiscard]] bool Await(rt::Nanoseconds time) OSTEON_RT {
    return WaitReadable(bound_.socket, time) != Wait::kNothing;
  }

  /// Sends to the peer. Returns false if there is no peer, or if the system did not accept the whole
  /// datagram.
  bool Send(std::span<const std::uint8_t> answer) OSTEON_RT {
    if (!has_peer_) return false;
    return sendto(bound_.socket, answer.data(), answer.size(), MSG_DONTWAIT | MSG_NOSIGNAL,
                  reinterpret_cast<const sockaddr*>(&peer_),
                  sizeof peer_) == static_cast<ssize_t>(answer.size());
  }

 private:
  // Checks the sender of message i of the batch, then lets the protocol evaluate the message. Returns true if
  // the message is valid; its sender is then the peer.
  template <class Protocol>
  bool AcceptMessage(Protocol& protocol, std::size_t i) OSTEON_RT {
    const sockaddr_in& sender = in_.sender(i);
    const rt::Nanoseconds arrival = ArrivalTime(in_.header(i));
    const bool known =
        has_peer_ && sender.sin_addr.s_addr == peer_.sin_addr.s_addr && sender.sin_port == peer_.sin_port;
    const bool foreign = from_ && sender.sin_addr.s_addr != from_->s_addr;
    if (foreign || (has_peer_ && !known && arrival - heard_ < kSilence)) {
      protocol.Reject();
      return false;
    }
    // start a session only if a new sender's datagram could be a message, so that other datagrams do not end
    // the present session
    if (!known && protocol.IsMessage(in_.bytes(i))) protocol.ResetSession();
    if (!protocol.Accept(in_.bytes(i), arrival)) return false;
    newest_ = in_.bytes(i);
    peer_ = sender;
    has_peer_ = true;
    heard_ = arrival;
    return true;
  }

  using Batch = MessageBatch<kMaxBytes, CMSG_SPACE(sizeof(timespec)), Sender::kKept>;

  BoundUdp bound_;
  std::optional<in_addr> from_;
  Batch in_;
  sockaddr_in peer_{};
  bool has_peer_{false};
  std::span<const std::uint8_t> newest_;
  rt::Nanoseconds heard_{0};  // time of the peer's last valid message
};

}  // namespace osteon::io
