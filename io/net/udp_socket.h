#pragma once

#include <netinet/in.h>
#include <sys/socket.h>

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include <tl/expected.hpp>

#include "base/clock.h"
#include "base/marker.h"

// Common functions of all our sockets: opening with errors that say what to do, waiting with a deadline, and
// the arrival time of a datagram.

namespace osteon::io {

/// Result of waiting on a socket.
enum class Wait : std::uint8_t {
  kReady,
  kNothing,  ///< nothing came until the deadline
  kGone,     ///< the socket is closed
};

/// Waits until the socket has something to read, at most until `deadline` on CLOCK_MONOTONIC; checks once
/// even if it has passed.
[[nodiscard]] Wait WaitReadable(int socket, rt::Nanoseconds deadline) OSTEON_RT;

/// Arrival time of a received message on CLOCK_MONOTONIC: the kernel stamps it on CLOCK_REALTIME
/// (SO_TIMESTAMPNS), and the age by that stamp is subtracted from the present time. The time of this call if
/// there is no such stamp, or if the real-time clock was set in between.
[[nodiscard]] rt::Nanoseconds ArrivalTime(msghdr& message) OSTEON_RT;

/// One datagram.
struct Datagram {
  enum class Read : std::uint8_t {
    kTaken,
    kNone,      ///< nothing waits
    kReported,  ///< the system reports that an earlier datagram of ours was undeliverable: read again
    kGone,      ///< the socket is closed
  };
  Read read{Read::kNone};
  std::span<const std::uint8_t> bytes{};  ///< cut if the room was too small
  sockaddr_in sender{};
  rt::Nanoseconds arrival{0};
};
/// Takes the first waiting datagram; never waits.
[[nodiscard]] Datagram ReadDatagram(int socket, std::span<std::uint8_t> room) OSTEON_RT;

/// Converts a dotted IPv4 address and a port. @param what  names the caller in the error, e.g. "FRI: bind"
[[nodiscard]] tl::expected<sockaddr_in, std::string> Ipv4(const std::string& what, const std::string& address,
                                                          std::uint16_t port);

/// Converts a dotted IPv4 address alone; an empty string gives no address.
[[nodiscard]] tl::expected<std::optional<in_addr>, std::string> PeerAddress(const std::string& what,
                                                                            const std::string& address);

/// A UDP socket that is bound to a port.
struct BoundUdp {
  int socket{-1};  ///< the caller must close it
  std::uint16_t port{0};
};
/// Opens a UDP socket on an address of this machine, with arrival times if the system has them. The error
/// names the caller, address and port, and says what to do. @param port  0: any free one
[[nodiscard]] tl::expected<BoundUdp, std::string> BindUdp(const std::string& who, const std::string& address,
                                                          std::uint16_t port);

/// Text of an errno, "no such file …".
[[nodiscard]] std::string SystemReason(int error);

}  // namespace osteon::io
