#pragma once

#include <netinet/in.h>
#include <sys/socket.h>

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include <tl/expected.hpp>

#include "control/rt/clock.h"
#include "control/rt/marker.h"

// What every socket of ours needs: to be opened with errors that say what to do, to wait with a deadline, and
// to know when a datagram reached this machine.

namespace osteon::io {

enum class Wait : std::uint8_t {
  kReady,
  kNothing,  ///< until the deadline
  kGone,     ///< the socket is closed
};

/// Waits until the socket has something to read, at most until `deadline` on CLOCK_MONOTONIC; looks once even
/// where it has passed.
[[nodiscard]] Wait WaitReadable(int socket, rt::Nanoseconds deadline) OSTEON_RT;

/// When a received message reached this machine, on CLOCK_MONOTONIC: the kernel stamps it on CLOCK_REALTIME
/// (SO_TIMESTAMPNS), its age carries over. The time of this call where there is no such stamp, or somebody
/// has set that clock in between.
[[nodiscard]] rt::Nanoseconds ArrivalTime(msghdr& message) OSTEON_RT;

/// One datagram.
struct Datagram {
  enum class Read : std::uint8_t {
    kTaken,
    kNone,      ///< nothing waits
    kReported,  ///< the system reports that an earlier datagram of ours found nobody: look again
    kGone,      ///< the socket is closed
  };
  Read read{Read::kNone};
  std::span<const std::uint8_t> bytes{};  ///< cut where the room ended
  sockaddr_in sender{};
  rt::Nanoseconds arrival{0};
};
/// What waits first; never waits itself.
[[nodiscard]] Datagram ReadDatagram(int socket, std::span<std::uint8_t> room) OSTEON_RT;

/// @param what  "FRI: bind": who asks, for the error
[[nodiscard]] tl::expected<sockaddr_in, std::string> Ipv4(const std::string& what, const std::string& address,
                                                          std::uint16_t port);

/// The address alone. Empty: none
[[nodiscard]] tl::expected<std::optional<in_addr>, std::string> PeerAddress(const std::string& what,
                                                                            const std::string& address);

struct BoundUdp {
  int socket{-1};  ///< the caller's to close
  std::uint16_t port{0};
};
/// A UDP socket on an address of this machine, with times of arrival where the system has them. The error
/// names who asks, address and port, and says what to do. @param port  0: any free one
[[nodiscard]] tl::expected<BoundUdp, std::string> BindUdp(const std::string& who, const std::string& address,
                                                          std::uint16_t port);

/// "no such file …" of an errno.
[[nodiscard]] std::string SystemReason(int error);

}  // namespace osteon::io
