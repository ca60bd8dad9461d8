#include "io/net/udp_socket.h"

#include <arpa/inet.h>
#include <poll.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>

namespace osteon::io {

Wait WaitReadable(int socket, rt::Nanoseconds deadline) OSTEON_RT {
  for (;;) {
    const rt::Nanoseconds left = std::max<rt::Nanoseconds>(0, deadline - rt::MonotonicNow());
    const timespec wait{.tv_sec = left / rt::kSecond, .tv_nsec = left % rt::kSecond};
    pollfd poll_socket{.fd = socket, .events = POLLIN, .revents = 0};
    const int ready = ppoll(&poll_socket, 1, &wait, nullptr);
    if (ready > 0) return (poll_socket.revents & POLLNVAL) != 0 ? Wait::kGone : Wait::kReady;
    if (ready < 0 && errno != EINTR) return Wait::kGone;
    if (rt::MonotonicNow() >= deadline) return Wait::kNothing;
  }
}

rt::Nanoseconds ArrivalTime(msghdr& message) OSTEON_RT {
  const rt::Nanoseconds now = rt::MonotonicNow();
  for (cmsghdr* part = CMSG_FIRSTHDR(&message); part != nullptr; part = CMSG_NXTHDR(&message, part)) {
    if (part->cmsg_level != SOL_SOCKET || part->cmsg_type != SCM_TIMESTAMPNS) continue;
    timespec arrived{}, real_now{};
    std::memcpy(&arrived, CMSG_DATA(part), sizeof arrived);
    clock_gettime(CLOCK_REALTIME, &real_now);
    const rt::Nanoseconds age =
        (real_now.tv_sec - arrived.tv_sec) * rt::kSecond + (real_now.tv_nsec - arrived.tv_nsec);
    if (age >= 0 && age < rt::kSecond) return now - age;
  }
  return now;
}

Datagram ReadDatagram(int socket, std::span<std::uint8_t> room) OSTEON_RT {
  Datagram datagram;
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(timespec))> control{};
  iovec bytes{.iov_base = room.data(), .iov_len = room.size()};
  msghdr message{};
  message.msg_name = &datagram.sender;
  message.msg_namelen = sizeof datagram.sender;
  message.msg_iov = &bytes;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  const ssize_t size = recvmsg(socket, &message, MSG_DONTWAIT);
  if (size < 0) {
    if (errno == EAGAIN || errno == EWOULDBLOCK)
      datagram.read = Datagram::Read::kNone;
    else
      datagram.read = errno == EBADF || errno == ENOTSOCK ? Datagram::Read::kGone : Datagram::Read::kReported;
    return datagram;
  }
  datagram.read = Datagram::Read::kTaken;
  datagram.bytes = room.first(static_cast<std::size_t>(size));
  datagram.arrival = ArrivalTime(message);
  return datagram;
}

tl::expected<sockaddr_in, std::string> Ipv4(const std::string& what, const std::string& address,
                                            std::uint16_t port) {
  sockaddr_in result{};
  result.sin_family = AF_INET;
  result.sin_port = htons(port);
  if (inet_pton(AF_INET, address.c_str(), &result.sin_addr) != 1)
    return tl::unexpected(what + " address '" + address +
                          "' is not an IPv4 address; accepted: four numbers such as 127.0.0.1, or 0.0.0.0 "
                          "for every network card");
  return result;
}

tl::expected<std::optional<in_addr>, std::string> PeerAddress(const std::string& what,
                                                              const std::string& address) {
  if (address.empty()) return std::nullopt;
  const auto peer = Ipv4(what, address, 0);
  if (!peer) return tl::unexpected(peer.error());
  return peer->sin_addr;
}

tl::expected<BoundUdp, std::string> BindUdp(const std::string& who, const std::string& address,
                                            std::uint16_t port) {
  auto own_address = Ipv4(who + ": bind", address, port);
  if (!own_address) return tl::unexpected(own_address.error());
  const std::string place = who + ": UDP " + address + ":" + std::to_string(port);
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return tl::unexpected(place + ": no socket: " + SystemReason(errno));
  // closes the socket, and returns the error
  const auto give_up = [fd](const std::string& text) {
    close(fd);
    return tl::unexpected(text);
  };
  if (bind(fd, reinterpret_cast<const sockaddr*>(&*own_address), sizeof *own_address) != 0) {
    const int error = errno;
    if (error == EADDRINUSE)
      return give_up(place +
                     " is taken by another program; end it (ss -ulpn shows it) or choose another port");
    if (error == EADDRNOTAVAIL)
      return give_up(place + ": this machine has no network card with that address (ip address shows them)");
    return give_up(place + ": cannot bind: " + SystemReason(error));
  }
  socklen_t length = sizeof *own_address;
  if (getsockname(fd, reinterpret_cast<sockaddr*>(&*own_address), &length) != 0)
    return give_up(place + ": " + SystemReason(errno));
  // Some sandboxes refuse this option; the time of reading then serves as the arrival time.
  const int on = 1;
  (void)setsockopt(fd, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on);
  return BoundUdp{.socket = fd, .port = ntohs(own_address->sin_port)};
}

std::string SystemReason(int error) { return std::generic_category().message(error); }

}  // namespace osteon::io
