#include "io/can/udp_can_bus.h"

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <random>

#include "io/net/udp_socket.h"

namespace osteon::io {
namespace {

constexpr int kMaxSkipped = 64;  // datagrams passed over in one call

std::string Place(const std::string& address, std::uint16_t port) {
  return "UDP " + address + ":" + std::to_string(port);
}

}  // namespace

UdpCanBus::UdpCanBus(int socket, std::vector<CanFilter> filters)
    : socket_(socket), filters_(std::move(filters)), session_(std::random_device{}()) {}

tl::expected<std::unique_ptr<UdpCanBus>, std::string> UdpCanBus::Open(const UdpCanParams& params) {
  const auto peer = Ipv4("CAN tunnel: peer", params.peer_address, params.peer_port);
  if (!peer) return tl::unexpected(peer.error());
  if (params.peer_port == 0)
    return tl::unexpected(std::string("CAN tunnel: peer port: found 0, accepted 1 … 65535"));
  const auto bound = BindUdp("CAN tunnel", params.bind_address, params.bind_port);
  if (!bound) return tl::unexpected(bound.error());
  const int fd = bound->socket;
  std::unique_ptr<UdpCanBus> bus(new UdpCanBus(fd, params.filters));  // closes fd on every way out
  // Connected, the system drops what anybody else sends.
  if (connect(fd, reinterpret_cast<const sockaddr*>(&*peer), sizeof *peer) != 0)
    return tl::unexpected("CAN tunnel: " + Place(params.bind_address, params.bind_port) +
                          ": cannot reach the peer " + Place(params.peer_address, params.peer_port) + ": " +
                          SystemReason(errno));
  bus->port_ = bound->port;
  // what came from anybody between the two
  for (int i = 0; i < kMaxSkipped; ++i)
    if (ReadDatagram(fd, bus->in_).read == Datagram::Read::kNone) break;
  return bus;
}

tl::expected<UdpCanBus::Pair, std::string> UdpCanBus::OpenPair() {
  // The first end learns the second's port afterwards: until then it is connected to the discard port, so
  // that at no time anybody is listened to.
  auto a = Open({.bind_port = 0, .peer_port = 9});
  if (!a) return tl::unexpected(a.error());
  auto b = Open({.bind_port = 0, .peer_port = (*a)->port_});
  if (!b) return tl::unexpected(b.error());
  const auto peer = Ipv4("CAN tunnel: peer", "127.0.0.1", (*b)->port_);
  if (connect((*a)->socket_, reinterpret_cast<const sockaddr*>(&*peer), sizeof *peer) != 0)
    return tl::unexpected("CAN tunnel: " + Place("127.0.0.1", (*a)->port_) + ": " + SystemReason(errno));
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
    const Datagram datagram = ReadDatagram(socket_, in_);
    if (datagram.read == Datagram::Read::kGone) return CanResult::kDown;
    if (datagram.read == Datagram::Read::kReported) continue;  // an earlier frame that nobody took
    if (datagram.read == Datagram::Read::kNone) return CanResult::kEmpty;
    UdpCanMessage parsed;
    if (DecodeUdpCan(datagram.bytes, parsed) != UdpCanError::kNone) {
      ++status_.rejected;
      continue;
    }
    if (!InOrder(parsed) || !Wanted(parsed.frame)) continue;
    arrival = {.frame = parsed.frame, .stamp = datagram.arrival, .after_gap = gap_};
    gap_ = false;
    ++status_.received;
    return CanResult::kOk;
  }
  return CanResult::kEmpty;
}

CanResult UdpCanBus::Receive(CanArrival& arrival, rt::Nanoseconds deadline) OSTEON_RT {
  for (;;) {
    if (const CanResult result = TryReceive(arrival); result != CanResult::kEmpty) return result;
    const Wait wait = WaitReadable(socket_, deadline);
    if (wait != Wait::kReady) return wait == Wait::kGone ? CanResult::kDown : CanResult::kEmpty;
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
