#pragma once

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

// A socket of the operating system as the peer of the code under test, so that no code is tested against
// itself.

namespace osteon::io::test {

/// 127.0.0.1 with that port.
inline sockaddr_in Loopback(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

/// A plain UDP or TCP socket of 127.0.0.1, at a port that the system chooses. Throws if there is no
/// descriptor; data that the far side does not accept fails the test.
class LoopbackSocket {
 public:
  explicit LoopbackSocket(int type = SOCK_DGRAM) : socket_(socket(AF_INET, type, 0)) {
    sockaddr_in own = Loopback(0);
    socklen_t size = sizeof own;
    if (socket_ < 0 || bind(socket_, reinterpret_cast<const sockaddr*>(&own), size) != 0 ||
        getsockname(socket_, reinterpret_cast<sockaddr*>(&own), &size) != 0)
      throw std::runtime_error("no socket on the loopback");
    port_ = ntohs(own.sin_port);
  }
  ~LoopbackSocket() { close(socket_); }
  LoopbackSocket(const LoopbackSocket&) = delete;
  LoopbackSocket& operator=(const LoopbackSocket&) = delete;

  [[nodiscard]] std::uint16_t port() const { return port_; }

  /// From now on Send() goes to this port, and only its datagrams are received.
  void Connect(std::uint16_t port) const {
    const sockaddr_in to = Loopback(port);
    EXPECT_EQ(connect(socket_, reinterpret_cast<const sockaddr*>(&to), sizeof to), 0);
  }
  void Send(std::span<const std::uint8_t> bytes) const {
    EXPECT_EQ(send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL), static_cast<ssize_t>(bytes.size()));
  }
  void SendTo(std::uint16_t port, std::span<const std::uint8_t> bytes) const {
    const sockaddr_in to = Loopback(port);
    EXPECT_EQ(
        sendto(socket_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to),
        static_cast<ssize_t>(bytes.size()));
  }

  /// The next data, up to 3000 bytes; nullopt if nothing came in time. TCP: empty if the far side has closed
  /// the connection. Loopback delivers within the sender's call, so data that is not here without waiting was
  /// never sent.
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> Receive(int wait_ms = 0) const {
    pollfd waiting{.fd = socket_, .events = POLLIN, .revents = 0};
    if (poll(&waiting, 1, wait_ms) != 1) return std::nullopt;
    std::vector<std::uint8_t> bytes(3000);
    const ssize_t size = recv(socket_, bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (size < 0 && errno != ECONNRESET) return std::nullopt;
    bytes.resize(size < 0 ? 0 : static_cast<std::size_t>(size));
    return bytes;
  }

  /// Receives the next datagram without waiting, and drops it. @returns the sender's port; 0: there was none
  [[nodiscard]] std::uint16_t ReceiveFrom() const {
    std::array<std::uint8_t, 3000> bytes;
    sockaddr_in from{};
    socklen_t size = sizeof from;
    const ssize_t taken = recvfrom(socket_, bytes.data(), bytes.size(), MSG_DONTWAIT,
                                   reinterpret_cast<sockaddr*>(&from), &size);
    return taken < 0 ? std::uint16_t{0} : ntohs(from.sin_port);
  }

 private:
  int socket_;
  std::uint16_t port_{0};
};

}  // namespace osteon::io::test
