#include "io/rsi/rsi_link.h"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <span>
#include <stdexcept>
#include <system_error>

namespace osteon::io {
namespace {

using control::ReceiveResult;

constexpr rt::Nanoseconds kPeerSilence = rt::kSecond;
constexpr int kMaxDrain = 64;  // datagrams read in one call: a flood must not hold the tick

std::string Reason(int error) { return std::generic_category().message(error); }

bool SameAddress(const sockaddr_in& a, const sockaddr_in& b) OSTEON_RT {
  return a.sin_addr.s_addr == b.sin_addr.s_addr && a.sin_port == b.sin_port;
}

// When the datagram reached this machine, on CLOCK_MONOTONIC. The kernel stamps it on CLOCK_REALTIME; its age
// carries over, unless somebody set that clock in between.
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

}  // namespace

tl::expected<std::unique_ptr<RsiLink>, std::string> RsiLink::Open(const RsiLinkParams& params) {
  const std::string place = "RSI: UDP " + params.bind_address + ":" + std::to_string(params.port);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(params.port);
  if (inet_pton(AF_INET, params.bind_address.c_str(), &address.sin_addr) != 1)
    return tl::unexpected("RSI: bind address '" + params.bind_address +
                          "' is not an IPv4 address; accepted: four numbers such as 127.0.0.1, "
                          "or 0.0.0.0 for every network card");

  try {
    (void)RsiSession(params.session);
  } catch (const std::invalid_argument& error) {
    return tl::unexpected(std::string(error.what()));
  }

  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return tl::unexpected(place + ": no socket: " + Reason(errno));
  std::unique_ptr<RsiLink> link(new RsiLink(fd, params));  // closes fd on every way out

  if (bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    const int error = errno;
    if (error == EADDRINUSE)
      return tl::unexpected(
          place + " is taken by another program; end it (ss -ulpn shows it) or choose another port");
    if (error == EADDRNOTAVAIL)
      return tl::unexpected(place +
                            ": this machine has no network card with that address (ip address shows them)");
    return tl::unexpected(place + ": cannot bind: " + Reason(error));
  }
  socklen_t length = sizeof address;
  if (getsockname(fd, reinterpret_cast<sockaddr*>(&address), &length) != 0)
    return tl::unexpected(place + ": " + Reason(errno));
  link->port_ = ntohs(address.sin_port);

  // Refused by some sandboxes; then the time of reading serves.
  const int on = 1;
  (void)setsockopt(fd, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on);
  return link;
}

RsiLink::~RsiLink() { close(socket_); }

ReceiveResult RsiLink::Receive(control::ArmState& state, rt::Nanoseconds deadline) OSTEON_RT {
  for (;;) {
    const rt::Nanoseconds left = std::max<rt::Nanoseconds>(0, deadline - rt::MonotonicNow());
    const timespec wait{.tv_sec = left / rt::kSecond, .tv_nsec = left % rt::kSecond};
    pollfd poll_socket{.fd = socket_, .events = POLLIN, .revents = 0};
    const int ready = ppoll(&poll_socket, 1, &wait, nullptr);
    if (ready < 0 && errno != EINTR) return ReceiveResult::kClosed;
    if (ready > 0 && (poll_socket.revents & POLLNVAL)) return ReceiveResult::kClosed;

    // Drain: the newest valid message wins.
    bool received = false;
    for (int i = 0; ready > 0 && i < kMaxDrain; ++i) {
      const Read read = ReadOne(state);
      if (read == Read::kBroken) return ReceiveResult::kClosed;
      if (read == Read::kEmpty) break;
      if (read == Read::kIgnored) continue;
      if (received) session_.CountSuperseded(state);
      received = true;
    }
    if (received) return ReceiveResult::kOk;
    if (rt::MonotonicNow() >= deadline) return ReceiveResult::kTimeout;
  }
}

RsiLink::Read RsiLink::ReadOne(control::ArmState& state) OSTEON_RT {
  sockaddr_in sender{};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(timespec))> control{};
  iovec bytes{.iov_base = buffer_.data(), .iov_len = buffer_.size()};
  msghdr message{};
  message.msg_name = &sender;
  message.msg_namelen = sizeof sender;
  message.msg_iov = &bytes;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  const ssize_t size = recvmsg(socket_, &message, MSG_DONTWAIT);
  if (size < 0) {
    if (errno == EAGAIN || errno == EWOULDBLOCK) return Read::kEmpty;
    // ECONNREFUSED and its kin report an earlier answer that nobody took: the controller is gone, the socket
    // is not.
    return errno == EBADF || errno == ENOTSOCK ? Read::kBroken : Read::kIgnored;
  }

  const rt::Nanoseconds stamp = ArrivalTime(message);
  const bool known = has_peer_ && SameAddress(sender, peer_);
  if (has_peer_ && !known) {
    if (stamp - heard_ < kPeerSilence) {
      session_.CountRejected(state);
      return Read::kIgnored;
    }
    session_.StartOver();
  }
  if (!has_peer_) session_.StartOver();  // what a stranger said before is nobody's beginning
  const std::span<const std::uint8_t> datagram(buffer_.data(), static_cast<std::size_t>(size));
  if (session_.Accept(datagram, stamp, state) != RsiAccept::kAccepted) return Read::kIgnored;
  peer_ = sender;
  has_peer_ = true;
  heard_ = stamp;
  return Read::kMessage;
}

bool RsiLink::Send(const control::ArmCommand& command) OSTEON_RT {
  if (!has_peer_) return false;
  const std::span<const std::uint8_t> answer = session_.Answer(command);
  if (answer.empty()) return true;
  const ssize_t sent = sendto(socket_, answer.data(), answer.size(), MSG_DONTWAIT | MSG_NOSIGNAL,
                              reinterpret_cast<const sockaddr*>(&peer_), sizeof peer_);
  return sent == static_cast<ssize_t>(answer.size());
}

}  // namespace osteon::io
