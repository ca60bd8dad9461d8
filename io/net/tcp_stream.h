#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

#include <tl/expected.hpp>

namespace osteon::io {

/// A TCP connection to a server on an IPv4 address, for measurements. It can be ended in the way in which the
/// connection of a killed program ends. For one thread.
class TcpStream {
 public:
  /// @returns the error names address and port.
  [[nodiscard]] static tl::expected<TcpStream, std::string> Connect(const std::string& address,
                                                                    std::uint16_t port);
  TcpStream(TcpStream&& other) noexcept;
  TcpStream& operator=(TcpStream&&) = delete;
  ~TcpStream();

  /// Sends all bytes. Returns false if the other end has closed the connection.
  [[nodiscard]] bool Send(std::string_view bytes);
  /// Returns the bytes that have arrived; waits for the first one. Empty if nothing arrived within
  /// `patience`, or if the other end has closed the connection.
  [[nodiscard]] std::string Receive(std::chrono::milliseconds patience);
  /// Whether a Receive has found that the other end has closed the connection, or that it broke.
  [[nodiscard]] bool closed() const { return closed_; }
  /// Ends the connection by a reset, as the system does for a killed process that has not read all received
  /// data.
  void Kill();

 private:
  explicit TcpStream(int socket) : socket_(socket) {}
  int socket_;
  bool closed_{false};
};

}  // namespace osteon::io
