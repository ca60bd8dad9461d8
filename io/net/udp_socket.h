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

// Functions that all sockets of this project share: opening with errors that say what to do, waiting with a
// deadline, and the arrival time of a datagram.

namespace osteon::io {

/// Result of waiting on a socket.
enum class Wait : std::uint8_t {
  kReady,
  kNothing,  ///< nothing arrived before the deadline
  kGone,     ///< the socket is closed
};

/// Waits until the socket has something to read, at most until `deadline` on CLOCK_MONOTONIC. Checks the
/// socket once even if the deadline has passed.
[[nodiscard]] Wait WaitReadable(int socket, rt::Nanoseconds deadline) OSTEON_RT;

/// Arrival time of a received message on CLOCK_MONOTONIC. The kernel stamps a message on CLOCK_REALTIME
/// (SO_TIMESTAMPNS); the message's age by this stamp is subtracted from the present time. Returns the time of
/// this call if there is no stamp, or if the age is negative or 1 s and more because the real-time clock was
/// set.
[[nodiscard]] rt::Nanoseconds ArrivalTime(msghdr& message) OSTEON_RT;

/// One datagram.
struct Datagram {
  enum class Read : std::uint8_t {
    kTaken,
    kNone,      ///< no datagram is waiting
    kReported,  ///< no datagram: the system reported that an earlier datagram, sent from this socket, could
                ///< not be delivered. Read again
    kGone,      ///< the socket is closed
  };
  Read read{Read::kNone};
  std::span<const std::uint8_t> bytes{};  ///< truncated if the caller's buffer was too small
  sockaddr_in sender{};
  rt::Nanoseconds arrival{0};
};
/// Reads the first waiting datagram into `room`; never waits.
[[nodiscard]] Datagram ReadDatagram(int socket, std::span<std::uint8_t> room) OSTEON_RT;

/// Converts a dotted IPv4 address and a port. @param what  beginning of the error, naming the caller, e.g.
/// "FRI: bind"
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
/// Opens a UDP socket on an address of this machine. Its datagrams have arrival times if the system supports
/// them. The error names the caller, address and port, and says what to do. @param port  0: any free one
[[nodiscard]] tl::expected<BoundUdp, std::string> BindUdp(const std::string& who, const std::string& address,
                                                          std::uint16_t port);

/// Text of an errno, "no such file …".
[[nodiscard]] std::string SystemReason(int error);

}  // namespace osteon::io
