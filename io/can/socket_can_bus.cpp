#include "io/can/socket_can_bus.h"

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "io/can/receive_batches.h"
#include "io/net/udp_socket.h"

namespace osteon::io {
namespace {

// largest number of error frames and invalid frames skipped in one call
constexpr std::size_t kMaxSkipped = 64;

// Finds the interface `name` and its index, with any CAN socket `fd`. Returns an error text, e.g. that the
// interface is down; empty if the interface is usable.
std::string WrongWithInterface(int fd, const std::string& name, int& index) {
  ifreq request{};
  if (name.empty() || name.size() >= sizeof request.ifr_name)
    return "accepted: an interface name of 1 to 15 characters, e.g. can0";
  std::copy(name.begin(), name.end(), request.ifr_name);
  if (ioctl(fd, SIOCGIFINDEX, &request) != 0)
    return "this machine has no such interface (ip -details link show type can)";
  index = request.ifr_ifindex;
  if (ioctl(fd, SIOCGIFFLAGS, &request) == 0 && (request.ifr_flags & IFF_UP) == 0)
    return "the interface is down; as root: ip link set " + name +
           " up type can bitrate 1000000 restart-ms 100 (a vcan: ip link set " + name + " up)";
  return {};
}

}  // namespace

tl::expected<std::unique_ptr<SocketCanBus>, std::string> SocketCanBus::Open(const SocketCanParams& params) {
  const std::string place = "CAN interface '" + params.interface + "': ";
  const int fd = socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, CAN_RAW);
  if (fd < 0)
    return tl::unexpected(place + "this kernel does not speak SocketCAN (" + SystemReason(errno) +
                          "); as root: modprobe can-raw, or use the UDP tunnel for a simulated cell");
  std::unique_ptr<SocketCanBus> bus(new SocketCanBus(fd));  // closes fd on every exit

  int index = 0;
  if (const std::string wrong = WrongWithInterface(fd, params.interface, index); !wrong.empty())
    return tl::unexpected(place + wrong);

  // Set the filters before bind, so that no other frames enter the queue.
  std::vector<can_filter> filters;
  for (const CanFilter& filter : params.filters)
    filters.push_back({.can_id = filter.id, .can_mask = filter.mask | CAN_EFF_FLAG | CAN_RTR_FLAG});
  if (filters.empty()) filters.push_back({.can_id = 0, .can_mask = CAN_EFF_FLAG | CAN_RTR_FLAG});
  // classes of error frames that HandleErrorFrame evaluates
  const can_err_mask_t errors =
      CAN_ERR_BUSOFF | CAN_ERR_RESTARTED | CAN_ERR_CRTL | CAN_ERR_TX_TIMEOUT | CAN_ERR_ACK | CAN_ERR_BUSERROR;
  const int loopback = params.local_loopback ? 1 : 0, on = 1, off = 0;
  if (setsockopt(fd, SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(),
                 static_cast<socklen_t>(filters.size() * sizeof(can_filter))) != 0 ||
      setsockopt(fd, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors, sizeof errors) != 0 ||
      setsockopt(fd, SOL_CAN_RAW, CAN_RAW_LOOPBACK, &loopback, sizeof loopback) != 0 ||
      setsockopt(fd, SOL_CAN_RAW, CAN_RAW_RECV_OWN_MSGS, &off, sizeof off) != 0)
    return tl::unexpected(place + "cannot set the socket up: " + SystemReason(errno));
  // If these options are not available, frames get the time of reading, and an overflow is not noticed.
  (void)setsockopt(fd, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on);
  (void)setsockopt(fd, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on);

  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = index;
  if (bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    return tl::unexpected(
        place + (errno == ENODEV ? "it is not a CAN interface" : "cannot bind: " + SystemReason(errno)));
  return bus;
}

SocketCanBus::~SocketCanBus() { close(socket_); }

CanResult SocketCanBus::Send(const CanFrame& frame) OSTEON_RT { return SendAll({&frame, 1}); }

CanResult SocketCanBus::SendAll(std::span<const CanFrame> frames) OSTEON_RT {
  CanResult result = CanResult::kOk;
  // removes the first `count` frames from the list and counts them as unsent
  const auto refuse = [&](std::size_t count, CanResult why) {
    status_.unsent += count;
    frames = frames.subspan(count);
    result = std::max(result, why);
  };
  while (!frames.empty()) {
    std::size_t count = 0;  // valid frames before the first invalid one
    for (; count < std::min(frames.size(), out_.kMax); ++count) {
      const CanFrame& frame = frames[count];
      if (frame.id > kCanMaxId || frame.size > CAN_MAX_DLEN) break;
      can_frame wire{};
      wire.can_id = frame.id;
      wire.can_dlc = frame.size;
      std::copy_n(frame.data.begin(), frame.size, wire.data);
      std::memcpy(out_.room(count).data(), &wire, sizeof wire);
    }
    if (count == 0) {
      refuse(1, CanResult::kFull);
      continue;
    }
    if (status_.bus_off) {
      refuse(count, CanResult::kDown);
      continue;
    }
    const int sent = out_.Send(socket_, count);
    if (sent > 0) {
      status_.sent += static_cast<std::uint64_t>(sent);
      frames = frames.subspan(static_cast<std::size_t>(sent));
    } else {
      const bool full = errno == ENOBUFS || errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR;
      refuse(frames.size(), full ? CanResult::kFull : CanResult::kDown);
    }
  }
  return result;
}

CanResult SocketCanBus::TryReceive(CanArrival& arrival) OSTEON_RT {
  std::size_t count = 0;
  return ReceiveAll({&arrival, 1}, count);
}

CanResult SocketCanBus::ReceiveAll(std::span<CanArrival> room, std::size_t& count) OSTEON_RT {
  const auto classify = [] {
    return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR ? EmptyReceive::kNothing
                                                                     : EmptyReceive::kDown;
  };
  const auto deliver = [this](std::size_t i, CanArrival& arrival) {
    return AcceptFrame(in_.bytes(i), in_.header(i), arrival);
  };
  return ReceiveBatches(in_, socket_, kMaxSkipped, room, count, classify, deliver);
}

// Evaluates a message of the socket. Returns true if it is a data frame, which is then in `arrival`. Reports
// of the kernel and of the CAN controller update the status.
bool SocketCanBus::AcceptFrame(std::span<const std::uint8_t> bytes, msghdr& message,
                               CanArrival& arrival) OSTEON_RT {
  // read the kernel's counter of frames that were dropped because the socket's queue was full
  for (cmsghdr* part = CMSG_FIRSTHDR(&message); part != nullptr; part = CMSG_NXTHDR(&message, part)) {
    if (part->cmsg_level != SOL_SOCKET || part->cmsg_type != SO_RXQ_OVFL) continue;
    std::uint32_t dropped = 0;
    std::memcpy(&dropped, CMSG_DATA(part), sizeof dropped);
    gap_ = gap_ || dropped != overflow_;
    status_.lost += dropped - overflow_;  // modulo 2^32, like the kernel's counter
    overflow_ = dropped;
  }
  can_frame wire{};
  if (bytes.size() == sizeof wire) std::memcpy(&wire, bytes.data(), sizeof wire);
  if (bytes.size() != sizeof wire || wire.can_dlc > CAN_MAX_DLEN) {
    ++status_.rejected;
    return false;
  }
  if ((wire.can_id & CAN_ERR_FLAG) != 0) {
    HandleErrorFrame(wire.can_id & CAN_ERR_MASK, wire.data);
    return false;
  }
  // a 29-bit identifier, or a remote request
  if ((wire.can_id & (CAN_EFF_FLAG | CAN_RTR_FLAG)) != 0) {
    ++status_.rejected;
    return false;
  }
  arrival = {};
  arrival.frame.id = static_cast<std::uint16_t>(wire.can_id & CAN_SFF_MASK);
  arrival.frame.size = wire.can_dlc;
  std::copy_n(wire.data, wire.can_dlc, arrival.frame.data.begin());
  arrival.stamp = ArrivalTime(message);
  arrival.after_gap = gap_;
  gap_ = false;
  ++status_.received;
  return true;
}

CanResult SocketCanBus::Receive(CanArrival& arrival, rt::Nanoseconds deadline) OSTEON_RT {
  for (;;) {
    if (const CanResult result = TryReceive(arrival); result != CanResult::kEmpty) return result;
    const Wait wait = WaitReadable(socket_, deadline);
    if (wait != Wait::kReady) return wait == Wait::kGone ? CanResult::kDown : CanResult::kEmpty;
  }
}

void SocketCanBus::HandleErrorFrame(std::uint32_t error_class, const std::uint8_t* data) OSTEON_RT {
  ++status_.error_frames;
  if ((error_class & CAN_ERR_BUSOFF) != 0) status_.bus_off = true;
  if ((error_class & CAN_ERR_RESTARTED) != 0)
    status_.bus_off = status_.error_passive = status_.error_warning = false;
  if ((error_class & CAN_ERR_CRTL) == 0) return;
  const std::uint8_t state = data[1];
  if ((state & (CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING)) != 0) status_.error_warning = true;
  if ((state & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE)) != 0) status_.error_passive = true;
  if ((state & CAN_ERR_CRTL_ACTIVE) != 0) status_.error_passive = status_.error_warning = false;
  if ((state & CAN_ERR_CRTL_RX_OVERFLOW) != 0) {
    ++status_.lost;  // the controller lost at least one frame
    gap_ = true;
  }
}

}  // namespace osteon::io
