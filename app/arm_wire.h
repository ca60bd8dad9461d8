#pragma once

#include <memory>
#include <span>
#include <string>
#include <variant>

#include <tl/expected.hpp>

#include "config/cell_config.h"
#include "control/ports.h"
#include "control/rt/clock.h"
#include "io/fri/fri_link.h"
#include "io/rsi/rsi_link.h"

// The wire to a cell's arm, whichever protocol its file chooses.

namespace osteon::app {

/// "FRI 1.15", "RSI im_free, axes, 4 ms". Says so where a lost answer makes the arm jump.
[[nodiscard]] std::string Describe(const config::ArmLinkConfig& link);

/// Its program can be asked to end the session; false: it has to notice by itself.
[[nodiscard]] bool CanAskToEnd(const config::ArmLinkConfig& link);

/// So long an arm's program is given to end the session when it is asked to.
inline constexpr rt::Nanoseconds kEndWithin = 100 * rt::kMillisecond;

/// The client's side in virtual time: bytes handed over in memory.
class ArmSession {
 public:
  explicit ArmSession(const config::ArmLinkConfig& link);

  /// True where the state is the datagram's content. See io::FriSession::Accept, io::RsiSession::Accept.
  bool Accept(std::span<const std::uint8_t> datagram, rt::Nanoseconds stamp, control::ArmState& state);
  /// The datagram that answers the message last accepted; empty where none is owed. Valid until the next
  /// call.
  [[nodiscard]] std::span<const std::uint8_t> Answer(const control::ArmCommand& command);

  /// The answers to come ask the arm's program to end the session. False where the protocol can not.
  bool RequestStop();

  /// What keeps the arm from being commanded; empty where nothing does.
  [[nodiscard]] std::string Diagnosis() const;

 private:
  std::variant<io::FriSession, io::RsiSession> session_;
  bool can_stop_;
};

/// The same in wall time, over a socket.
class ArmWire {
 public:
  /// The error names address and port, and says what to do.
  /// @param peer  who alone is heard, IPv4; empty: the first that speaks
  [[nodiscard]] static tl::expected<ArmWire, std::string> Open(const config::ArmLinkConfig& link,
                                                               const std::string& peer);

  [[nodiscard]] control::ArmLink& link();

  /// Asks the arm's program to end the session, where the protocol can, and waits until it has, kEndWithin at
  /// most: an arm that is left without answers ends by a fault of its own.
  void End();

  /// What keeps the arm from being commanded; empty where nothing does.
  [[nodiscard]] std::string Diagnosis() const;

 private:
  using Link = std::variant<std::unique_ptr<io::FriLink>, std::unique_ptr<io::RsiLink>>;
  ArmWire(Link link, bool can_stop) : link_(std::move(link)), can_stop_(can_stop) {}

  Link link_;
  bool can_stop_;
};

}  // namespace osteon::app
