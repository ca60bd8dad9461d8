#pragma once

#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <system_error>

#include "io/net/udp_socket.h"

namespace osteon::hil {

/// A device's end of a UDP link on which the device sends first. The socket is connected to the peer, so the
/// system drops datagrams of other senders.
class UdpClient {
 public:
  static constexpr int kMaxAtOnce = 64;  ///< largest number of datagrams read in one call

  /// @param who, what  names of this side and of the peer in error texts, e.g. "simulated arm" and "client"
  /// @throws std::invalid_argument on the address or port, std::system_error if no socket can be opened.
  UdpClient(const std::string& who, const std::string& what, const std::string& address, std::uint16_t port) {
    const auto peer = io::Ipv4(who + ": " + what, address, port);
    if (!peer) throw std::invalid_argument(peer.error());
    if (port == 0) throw std::invalid_argument(who + ": " + what + "_port: found 0, accepted 1 … 65535");
    socket_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (socket_ < 0) throw std::system_error(errno, std::generic_category(), who + ": UDP socket");
    sockaddr_in own{};
    socklen_t size = sizeof own;
    if (connect(socket_, reinterpret_cast<const sockaddr*>(&*peer), sizeof *peer) != 0 ||
        getsockname(socket_, reinterpret_cast<sockaddr*>(&own), &size) != 0) {
      const int error = errno;
      Close();
      throw std::system_error(error, std::generic_category(),
                              who + ": UDP to " + address + ":" + std::to_string(port));
    }
    port_ = ntohs(own.sin_port);
  }
  ~UdpClient() { Close(); }
  UdpClient(const UdpClient&) = delete;
  UdpClient& operator=(const UdpClient&) = delete;

  void Close() {
    if (socket_ >= 0) close(socket_);
    socket_ = -1;
  }
  /// Local port from which this side sends.
  [[nodiscard]] std::uint16_t port() const { return port_; }

  /// Sends a datagram. Returns false if the system could not deliver it, e.g. because nobody listens yet.
  bool Send(std::span<const std::uint8_t> datagram) {
    return send(socket_, datagram.data(), datagram.size(), MSG_NOSIGNAL) >= 0;
  }

  /// Sleeps until `time` on CLOCK_MONOTONIC, or until a datagram has arrived.
  void WaitUntil(rt::Nanoseconds time) const { static_cast<void>(io::WaitReadable(socket_, time)); }

  /// Calls deliver(datagram) for each received datagram. @returns the number of sent datagrams that the
  /// system has reported as undeliverable since the last call
  template <class Deliver>
  std::uint64_t ReceiveAll(std::span<std::uint8_t> room, Deliver&& deliver) {
    std::uint64_t undelivered = 0;
    for (int i = 0; i < kMaxAtOnce; ++i) {
      const io::Datagram datagram = io::ReadDatagram(socket_, room);
      if (datagram.read == io::Datagram::Read::kReported)
        ++undelivered;
      else if (datagram.read == io::Datagram::Read::kTaken)
        deliver(datagram.bytes);
      else
        break;
    }
    return undelivered;
  }

 private:
  int socket_{-1};
  std::uint16_t port_{0};
};

}  // namespace osteon::hil
