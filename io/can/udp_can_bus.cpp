#include "io/can/udp_can_bus.h"

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <random>

#include "io/can/receive_batches.h"
#include "io/net/udp_socket.h"

namespace osteon::io {
namespace {

constexpr std::size_t kMaxSkipped = 64;  // largest number of datagrams skipped in one call

// Returns "UDP ADDRESS:PORT", for error texts.
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
  std::unique_ptr<UdpCanBus> bus(new UdpCanBus(fd, params.filters));  // closes fd on every exit
  // Connect the socket to the peer, so that the system drops datagrams of other senders.
  if (connect(fd, reinterpret_cast<const sockaddr*>(&*peer), sizeof *peer) != 0)
    return tl::unexpected("CAN tunnel: " + Place(params.bind_address, params.bind_port) +
                          ": cannot reach the peer " + Place(params.peer_address, params.peer_port) + ": " +
                          SystemReason(errno));
  bus->port_ = bound->port;
  // discard datagrams of other senders that arrived before the connect
  for (std::size_t i = 0; i < kMaxSkipped && bus->in_.Receive(fd, 1) > 0; ++i) {
  }
  return bus;
}

tl::expected<UdpCanBus::Pair, std::string> UdpCanBus::OpenPair() {
  // The first end is opened before the second end has a port. In between, the first end is connected to the
  // discard port (9), so that it does not receive datagrams of other senders.
  auto first = Open({.bind_port = 0, .peer_port = 9});
  if (!first) return tl::unexpected(first.error());
  auto second = Open({.bind_port = 0, .peer_port = (*first)->port_});
  if (!second) return tl::unexpected(second.error());
  const auto peer = Ipv4("CAN tunnel: peer", "127.0.0.1", (*second)->port_);
  if (connect((*first)->socket_, reinterpret_cast<const sockaddr*>(&*peer), sizeof *peer) != 0)
    return tl::unexpected("CAN tunnel: " + Place("127.0.0.1", (*first)->port_) + ": " + SystemReason(errno));
  return Pair(std::move(*first), std::move(*second));
}

UdpCanBus::~UdpCanBus() { close(socket_); }

CanResult UdpCanBus::Send(const CanFrame& frame) OSTEON_RT { return SendAll({&frame, 1}); }

CanResult UdpCanBus::SendAll(std::span<const CanFrame> frames) OSTEON_RT {
  CanResult result = CanResult::kOk;
  while (!frames.empty()) {
    // number of valid frames before the first invalid one; an invalid frame gets no sequence number
    std::size_t count = 0;
    for (; count < std::min(frames.size(), out_.kMax); ++count) {
      const auto number = sequence_ + static_cast<std::uint32_t>(count);
      const std::size_t size =
          EncodeUdpCan({.frame = frames[count], .session = session_, .sequence = number}, out_.room(count));
      if (size == 0) break;
      out_.SetSize(count, size);
    }
    const int sent = count > 0 ? out_.Send(socket_, count) : 0;
    const auto accepted = static_cast<std::size_t>(std::max(sent, 0));
    status_.sent += accepted;
    sequence_ += static_cast<std::uint32_t>(accepted);
    frames = frames.subspan(accepted);
    if (count > 0 && accepted == count) continue;
    // The system refused the next frame. If its queue is full or the socket is gone, all remaining frames
    // fail. Only this frame fails if it is invalid, or if the system used the call to report that an earlier
    // datagram was undeliverable.
    const bool down = sent < 0 && (errno == EBADF || errno == ENOTSOCK);
    const bool full = sent < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == ENOBUFS);
    const std::size_t refused = down || full ? frames.size() : 1;
    status_.unsent += refused;
    frames = frames.subspan(refused);
    result = std::max(result, down ? CanResult::kDown : CanResult::kFull);
  }
  return result;
}

CanResult UdpCanBus::TryReceive(CanArrival& arrival) OSTEON_RT {
  std::size_t count = 0;
  return ReceiveAll({&arrival, 1}, count);
}

CanResult UdpCanBus::ReceiveAll(std::span<CanArrival> room, std::size_t& count) OSTEON_RT {
  const auto classify = [] {
    if (errno == EBADF || errno == ENOTSOCK) return EmptyReceive::kDown;
    return errno == EAGAIN || errno == EWOULDBLOCK ? EmptyReceive::kNothing : EmptyReceive::kReport;
  };
  const auto deliver = [this](std::size_t i, CanArrival& arrival) {
    if (!AcceptDatagram(in_.bytes(i), arrival)) return false;
    arrival.stamp = ArrivalTime(in_.header(i));
    return true;
  };
  return ReceiveBatches(in_, socket_, kMaxSkipped, room, count, classify, deliver);
}

// Decodes a datagram. Returns true if its frame is valid, newer than the previous frames and passes the
// filters; the frame is then in `arrival`.
bool UdpCanBus::AcceptDatagram(std::span<const std::uint8_t> datagram, CanArrival& arrival) OSTEON_RT {
  UdpCanMessage parsed;
  if (DecodeUdpCan(datagram, parsed) != UdpCanError::kNone) {
    ++status_.rejected;
    return false;
  }
  if (!InOrder(parsed) || !PassesFilter(parsed.frame)) return false;
  arrival = {.frame = parsed.frame, .stamp = 0, .after_gap = gap_};
  gap_ = false;
  ++status_.received;
  return true;
}

CanResult UdpCanBus::Receive(CanArrival& arrival, rt::Nanoseconds deadline) OSTEON_RT {
  for (;;) {
    if (const CanResult result = TryReceive(arrival); result != CanResult::kEmpty) return result;
    const Wait wait = WaitReadable(socket_, deadline);
    if (wait != Wait::kReady) return wait == Wait::kGone ? CanResult::kDown : CanResult::kEmpty;
  }
}

// Updates the counters of lost and duplicate frames from the sequence number. Returns false if the frame was
// received before, or was overtaken by a newer one.
bool UdpCanBus::InOrder(const UdpCanMessage& message) OSTEON_RT {
  if (!heard_ || message.session != peer_session_) {
    heard_ = true;
    peer_session_ = message.session;
    expected_ = message.sequence;
  }
  const std::uint32_t ahead = message.sequence - expected_;
  if (ahead >= 0x8000'0000u) {  // negative modulo 2^32: older than expected
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

bool UdpCanBus::PassesFilter(const CanFrame& frame) const OSTEON_RT {
  if (filters_.empty()) return true;
  return std::any_of(filters_.begin(), filters_.end(), [&](const CanFilter& filter) {
    return (frame.id & filter.mask) == (filter.id & filter.mask);
  });
}

}  // namespace osteon::io
