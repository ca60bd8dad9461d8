#pragma once

#include <cstdint>
#include <optional>
#include <string>

// Checks of a cell's network, for the person who sets the cell up. None of them is called while a cell runs.

namespace osteon::io {

/// A network interface of this machine.
struct NetworkCard {
  std::string name;
  bool is_up{false};      ///< switched on
  bool has_cable{false};  ///< the card has a carrier: a cable with a device at its other end
};
/// The interface that has an IPv4 address; nothing if none has.
[[nodiscard]] std::optional<NetworkCard> FindNetworkCard(const std::string& address);

/// Tries to open a TCP connection to an IPv4 address, and closes it at once.
/// @param patience_ms  how long to wait for an answer  @returns why it was not accepted; empty: it was
[[nodiscard]] std::string WhyNoTcpConnection(const std::string& address, std::uint16_t port, int patience_ms);

}  // namespace osteon::io
