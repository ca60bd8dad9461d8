#pragma once

#include <memory>
#include <span>
#include <string>
#include <variant>

#include <tl/expected.hpp>

#include "base/clock.h"
#include "config/reading/cell_config.h"
#include "control/ports.h"
#include "io/fri/fri_link.h"
#include "io/rsi/rsi_link.h"

// The connection to a cell's arm by the protocol that the cell's file names.

namespace osteon::session {

/// Names the protocol: "FRI 1.15", "RSI im_free, axes, 4 ms". Adds a warning if a lost answer would make the
/// arm jump.
[[nodiscard]] std::string Describe(const config::ArmLinkConfig& link);

/// Whether the protocol can ask the arm's program to end the session. If not, the program has to notice by
/// itself that the answers have stopped.
[[nodiscard]] bool CanRequestStop(const config::ArmLinkConfig& link);

/// Longest wait for the arm's program to end the session after it was asked to.
inline constexpr rt::Nanoseconds kMaxEndDelay = 100 * rt::kMillisecond;

/// The client's side of the connection in virtual time: datagrams are passed in memory.
class ArmProtocolSession {
 public:
  explicit ArmProtocolSession(const config::ArmLinkConfig& link);

  /// Decodes a datagram. Returns true if `state` now has its content. See io::FriSession::Accept,
  /// io::RsiSession::Accept.
  bool Accept(std::span<const std::uint8_t> datagram, rt::Nanoseconds stamp, control::ArmState& state);
  /// Returns the datagram that answers the last accepted message; empty if no answer is due. Valid until the
  /// next call.
  [[nodiscard]] std::span<const std::uint8_t> Answer(const control::ArmCommand& command);

  /// Makes the next answers ask the arm's program to end the session. False if the protocol cannot.
  bool RequestStop();

  /// Says what prevents commanding the arm; empty: nothing does.
  [[nodiscard]] std::string Diagnosis() const;

 private:
  std::variant<io::FriSession, io::RsiSession> session_;
  bool can_stop_;
};

/// The client's side of the connection in wall time, over a socket.
class ArmConnection {
 public:
  /// Opens the socket. The error names address and port, and says what to do.
  /// @param peer  IPv4 address of the only accepted sender; empty: the first sender
  [[nodiscard]] static tl::expected<ArmConnection, std::string> Open(const config::ArmLinkConfig& link,
                                                                     const std::string& peer);

  [[nodiscard]] control::ArmLink& link();

  /// Asks the arm's program to end the session, if the protocol can, and waits for that end, at most
  /// kMaxEndDelay. Without this call, the arm would miss the answers and stop with a fault of its own.
  void EndSession();

  /// Says what prevents commanding the arm; empty: nothing does.
  [[nodiscard]] std::string Diagnosis() const;

 private:
  using Link = std::variant<std::unique_ptr<io::FriLink>, std::unique_ptr<io::RsiLink>>;
  ArmConnection(Link link, bool can_stop) : link_(std::move(link)), can_stop_(can_stop) {}

  Link link_;
  bool can_stop_;
};

}  // namespace osteon::session
