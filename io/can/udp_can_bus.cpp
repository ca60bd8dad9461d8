#include "io/can/udp_can_bus.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <random>
#include <system_error>

#include "io/can/socket_wait.h"

namespace osteon::io {
namespace {

constexpr int kMaxSkipped = 64;  // datagrams passed over in one call

std::string Reason(int error) { return std::generic_category().message(error); }

std::string Place(const std::string& address, std::uint16_t port) {
  return "UDP " + address + ":" + std::to_string(port);
}

tl::expected<sockaddr_in, std::string> Address(const std::string& what, const std::string& address,
                                               std::uint16_t port) {
  sockaddr_in result{};
  result.sin_family = AF_INET;
  result.sin_port = htons(port);
  if (inet_pton(AF_INET, address.c_str(), &result.sin_addr) != 1)
    return tl::unexpected("CAN tunnel: " + what + " address '" + address +
                          "' is not an IPv4 address; accepted: four numbers such as 127.0.0.1");
  return result;
}

}  // namespace

UdpCanBus::UdpCanBus(int socket, std::vector<CanFilter> filters)
    : socket_(socket), filters_(std::move(filters)), session_(std::random_device{}()) {}

tl::expected<std::unique_ptr<UdpCanBus>, std::string> UdpCanBus::Open(const UdpCanParams& params) {
  const auto here = Address("bind", params.bind_address, params.bind_port);
  if (!here) return tl::unexpected(here.error());
  const auto peer = Address("peer", params.peer_address, params.peer_port);
  if (!peer) return tl::unexpected(peer.error());
  if (params.peer_port == 0)
    return tl::unexpected(std::string("CAN tunnel: peer port: found 0, accepted 1 … 65535"));
  const std::string place = "CAN tunnel: " + Place(params.bind_address, params.bind_port);

  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (fd < 0) return tl::unexpected(place + ": no socket: " + Reason(errno));
  std::unique_ptr<UdpCanBus> bus(new UdpCanBus(fd, params.filters));  // closes fd on every way out
  if (bind(fd, reinterpret_cast<const sockaddr*>(&*here), sizeof *here) != 0) {
    const int error = errno;
    if (error == EADDRINUSE)
      return tl::unexpected(
          place + " is taken by another program; end it (ss -ulpn shows it) or choose another port");
    if (error == EADDRNOTAVAIL)
      return tl::unexpected(place +
                            ": this machine has no network card with that address (ip address shows them)");
    return tl::unexpected(place + ": cannot bind: " + Reason(error));
  }
  // Connected, the system drops what anybody else sends.
  if (connect(fd, reinterpret_cast<const sockaddr*>(&*peer), sizeof *peer) != 0)
    return tl::unexpected(place + ": cannot reach the peer " + Place(params.peer_address, params.peer_port) +
                          ": " + Reason(errno));
  sockaddr_in bound{};
  socklen_t length = sizeof bound;
  if (getsockname(fd, reinterpret_cast<sockaddr*>(&bound), &length) != 0)
    return tl::unexpected(place + ": " + Reason(errno));
  bus->port_ = ntohs(bound.sin_port);
  const int on = 1;
  (void)setsockopt(fd, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on);
  return bus;
}

tl::expected<UdpCanBus::Pair, std::string> UdpCanBus::OpenPair() {
  // The first end learns the second's port afterwards: until then it is connected to the discard port, so
  // that at no time anybody is listened to.
  auto a = Open({.bind_port = 0, .peer_port = 9});
  if (!a) return tl::unexpected(a.error());
  auto b = Open({.bind_port = 0, .peer_port = (*a)->port_});
  if (!b) return tl::unexpected(b.error());
  const auto peer = Address("peer", "127.0.0.1", (*b)->port_);
  if (connect((*a)->socket_, reinterpret_cast<const sockaddr*>(&*peer), sizeof *peer) != 0)
    return tl::unexpected("CAN tunnel: " + Place("127.0.0.1", (*a)->port_) + ": " + Reason(errno));
  return Pair(std::move(*a), std::move(*b));
}

UdpCanBus::~UdpCanBus() { close(socket_); }

CanResult UdpCanBus::Send(const CanFrame& frame) OSTEON_RT {
  CanResult result = CanResult::kFull;
  const std::size_t size = EncodeUdpCan({.frame = frame, .session = session_, .sequence = sequence_}, out_);
  if (size > 0) {
    if (send(socket_, out_.data(), size, MSG_DONTWAIT | MSG_NOSIGNAL) == static_cast<ssize_t>(size)) {
      result = CanResult::kOk;
      ++sequence_;
    } else if (errno == EBADF || errno == ENOTSOCK) {
      result = CanResult::kDown;
    }
  }
  ++(result == CanResult::kOk ? status_.sent : status_.unsent);
  return result;
}

CanResult UdpCanBus::TryReceive(CanArrival& arrival) OSTEON_RT {
  for (int i = 0; i < kMaxSkipped; ++i) {
    alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(timespec))> control{};
    iovec bytes{.iov_base = in_.data(), .iov_len = in_.size()};
    msghdr message{};
    message.msg_iov = &bytes;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    const ssize_t size = recvmsg(socket_, &message, MSG_DONTWAIT);
    if (size < 0) {
      if (errno == EBADF || errno == ENOTSOCK) return CanResult::kDown;
      if (errno == ECONNREFUSED) continue;  // reports an earlier frame that nobody took
      return CanResult::kEmpty;
    }
    UdpCanMessage parsed;
    if (DecodeUdpCan({in_.data(), static_cast<std::size_t>(size)}, parsed) != UdpCanError::kNone) {
      ++status_.rejected;
      continue;
    }
    if (!InOrder(parsed) || !Wanted(parsed.frame)) continue;
    arrival = {.frame = parsed.frame, .stamp = ArrivalTime(message), .after_gap = gap_};
    gap_ = false;
    ++status_.received;
    return CanResult::kOk;
  }
  return CanResult::kEmpty;
}

CanResult UdpCanBus::Receive(CanArrival& arrival, rt::Nanoseconds deadline) OSTEON_RT {
  for (;;) {
    if (const CanResult result = TryReceive(arrival); result != CanResult::kEmpty) return result;
    if (const CanResult result = WaitReadable(socket_, deadline); result != CanResult::kOk) return result;
  }
}

// Counts what the sequence number tells; false where the frame is old.
bool UdpCanBus::InOrder(const UdpCanMessage& message) OSTEON_RT {
  if (!heard_ || message.session != peer_session_) {
    heard_ = true;
    peer_session_ = message.session;
    expected_ = message.sequence;
  }
  const std::uint32_t ahead = message.sequence - expected_;
  if (ahead >= 0x8000'0000u) {
    ++status_.duplicate;
    return false;
  }
  if (ahead > 0) {
    status_.lost += ahead;
    gap_ = true;
  }
  expected_ = message.sequence + 1;
  return true;
}

bool UdpCanBus::Wanted(const CanFrame& frame) const OSTEON_RT {
  if (filters_.empty()) return true;
  return std::any_of(filters_.begin(), filters_.end(), [&](const CanFilter& filter) {
    return (frame.id & filter.mask) == (filter.id & filter.mask);
  });
}

}  // namespace osteon::io
