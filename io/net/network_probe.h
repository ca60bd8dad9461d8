#pragma once

#include <cstdint>
#include <optional>
#include <string>

// Whether a cell's network is there, for who sets it up: nothing of this is called while a cell runs.

namespace osteon::io {

/// A network interface of this machine.
struct NetworkCard {
  std::string name;
  bool is_up{false};      ///< switched on
  bool has_cable{false};  ///< a carrier is there
};
/// The interface that has an IPv4 address; nothing if none has.
[[nodiscard]] std::optional<NetworkCard> FindNetworkCard(const std::string& address);

/// Why nobody accepts a TCP connection at an IPv4 address; empty: somebody does. The connection is closed at
/// once. @param patience_ms  how long to wait for an answer
[[nodiscard]] std::string WhyNoTcpConnection(const std::string& address, std::uint16_t port, int patience_ms);

}  // namespace osteon::io
