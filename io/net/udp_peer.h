#pragma once

#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include <tl/expected.hpp>

#include "control/ports.h"
#include "io/net/udp_socket.h"

namespace osteon::io {

/// The PC's end of a protocol in which the other side speaks first: answers go to where its message came
/// from. The first sender of a valid message is the peer: others are rejected, until the peer has been silent
/// for a second (one that was restarted may come back from another port). Of several messages that wait, the
/// newest counts. One thread at a time; no allocation once opened, no system calls but the socket's and the
/// clock's.
class UdpPeer {
 public:
  static constexpr rt::Nanoseconds kSilence = rt::kSecond;

  explicit UdpPeer(const BoundUdp& bound) : bound_(bound) {}
  ~UdpPeer() {
    if (bound_.socket >= 0) close(bound_.socket);
  }
  UdpPeer(UdpPeer&& other) noexcept
      : bound_(other.bound_), peer_(other.peer_), has_peer_(other.has_peer_), heard_(other.heard_) {
    other.bound_.socket = -1;
  }
  UdpPeer& operator=(UdpPeer&&) = delete;

  [[nodiscard]] std::uint16_t port() const { return bound_.port; }
  [[nodiscard]] bool has_peer() const OSTEON_RT { return has_peer_; }

  /// Waits for valid messages until `deadline` on CLOCK_MONOTONIC; takes what has arrived even where it has
  /// passed. `protocol` judges them, without allocation:
  ///
  ///     bool Accept(std::span<const std::uint8_t> datagram, rt::Nanoseconds arrival)   valid?
  ///     void Reject()      a stranger's
  ///     void StartOver()   what comes next is of another peer than what came before
  ///     void Superseded()  a valid message was overtaken by a newer one that waited, too
  template <class Protocol>
  control::ReceiveResult Receive(Protocol&& protocol, std::span<std::uint8_t> room,
                                 rt::Nanoseconds deadline) OSTEON_RT {
    constexpr int kMostAtOnce = 64;  // a flood must not hold the tick
    for (;;) {
      const Wait wait = WaitReadable(bound_.socket, deadline);
      if (wait == Wait::kGone) return control::ReceiveResult::kClosed;
      bool received = false;
      for (int i = 0; wait == Wait::kReady && i < kMostAtOnce; ++i) {
        const Datagram datagram = ReadDatagram(bound_.socket, room);
        if (datagram.read == Datagram::Read::kGone) return control::ReceiveResult::kClosed;
        if (datagram.read == Datagram::Read::kNone) break;
        if (datagram.read == Datagram::Read::kReported || !Take(protocol, datagram)) continue;
        if (received) protocol.Superseded();
        received = true;
      }
      if (received) return control::ReceiveResult::kOk;
      if (rt::MonotonicNow() >= deadline) return control::ReceiveResult::kTimeout;
    }
  }

  /// To the peer. False where there is none, or the system did not take it whole.
  bool Send(std::span<const std::uint8_t> answer) OSTEON_RT {
    if (!has_peer_) return false;
    return sendto(bound_.socket, answer.data(), answer.size(), MSG_DONTWAIT | MSG_NOSIGNAL,
                  reinterpret_cast<const sockaddr*>(&peer_),
                  sizeof peer_) == static_cast<ssize_t>(answer.size());
  }

 private:
  template <class Protocol>
  bool Take(Protocol& protocol, const Datagram& datagram) OSTEON_RT {
    const bool known = has_peer_ && datagram.sender.sin_addr.s_addr == peer_.sin_addr.s_addr &&
                       datagram.sender.sin_port == peer_.sin_port;
    if (has_peer_ && !known && datagram.arrival - heard_ < kSilence) {
      protocol.Reject();
      return false;
    }
    if (!known) protocol.StartOver();  // what a stranger said before is nobody's beginning
    if (!protocol.Accept(datagram.bytes, datagram.arrival)) return false;
    peer_ = datagram.sender;
    has_peer_ = true;
    heard_ = datagram.arrival;
    return true;
  }

  BoundUdp bound_;
  sockaddr_in peer_{};
  bool has_peer_{false};
  rt::Nanoseconds heard_{0};  // when the peer last sent a valid message
};

}  // namespace osteon::io
