#pragma once

#include <cstdint>
#include <optional>
#include <string>

// Checks of a cell's network, for the person who sets the cell up. None of them is called while a cell runs.

namespace osteon::io {

/// A network interface of this machine.
struct NetworkCard {
  std::string name;
  bool is_up{false};      ///< the interface is enabled
  bool has_cable{false};  ///< the card has a carrier: a cable with a device at its other end
};
/// Returns the interface that has this IPv4 address; nothing if no interface has it.
[[nodiscard]] std::optional<NetworkCard> FindNetworkCard(const std::string& address);

/// Tries to open a TCP connection to an IPv4 address, and closes it at once.
/// @param patience_ms  longest wait for an answer  @returns why the connection was not accepted; empty if it
/// was
[[nodiscard]] std::string WhyNoTcpConnection(const std::string& address, std::uint16_t port, int patience_ms);

}  // namespace osteon::io
