#include "hil/injection/impaired_can_bus.h"

#include <algorithm>
#include <array>
#include <utility>

namespace osteon::hil {
namespace {

using io::CanResult;

// largest number of frames read in one call, so that the call returns even if frames keep arriving
constexpr int kMaxReads = 128;
constexpr std::size_t kIdBytes = 2;
// Room for the frames of one second on a full bus.
constexpr WireRoom kRoom{.datagrams = 8192, .bytes = kIdBytes + 8, .intact = kIdBytes};

using Bytes = std::array<std::uint8_t, kIdBytes + 8>;

// Packs a frame as a datagram of ImpairedWire: its identifier, low byte first, then its data.
std::span<const std::uint8_t> PackFrame(const io::CanFrame& frame, Bytes& bytes) OSTEON_RT {
  const std::size_t size = std::min<std::size_t>(frame.size, frame.data.size());
  bytes[0] = static_cast<std::uint8_t>(frame.id);
  bytes[1] = static_cast<std::uint8_t>(frame.id >> 8);
  std::copy_n(frame.data.begin(), size, bytes.begin() + kIdBytes);
  return {bytes.data(), kIdBytes + size};
}

io::CanFrame UnpackFrame(std::span<const std::uint8_t> bytes) OSTEON_RT {
  io::CanFrame frame{.id = static_cast<std::uint16_t>(bytes[0] | bytes[1] << 8),
                     .size = static_cast<std::uint8_t>(bytes.size() - kIdBytes)};
  std::copy(bytes.begin() + kIdBytes, bytes.end(), frame.data.begin());
  return frame;
}

}  // namespace

ImpairedCanBus::ImpairedCanBus(io::CanBus& bus, const InjectionParams& params, Wire wire,
                               std::vector<io::CanFilter> frames, const rt::Nanoseconds* virtual_now)
    : bus_(bus),
      frames_(std::move(frames)),
      virtual_now_(virtual_now),
      to_controller_(params, wire, Direction::kToController, kRoom),
      from_controller_(params, wire, Direction::kFromController, kRoom) {}

void ImpairedCanBus::StartSchedule(rt::Nanoseconds now) OSTEON_RT {
  to_controller_.StartSchedule(now);
  from_controller_.StartSchedule(now);
}

bool ImpairedCanBus::IsOfWire(const io::CanFrame& frame) const OSTEON_RT {
  return frames_.empty() || std::any_of(frames_.begin(), frames_.end(), [&](const io::CanFilter& filter) {
           return (frame.id & filter.mask) == (filter.id & filter.mask);
         });
}

CanResult ImpairedCanBus::SendDue(rt::Nanoseconds now) OSTEON_RT {
  while (to_controller_.NextDue() <= now) {
    const CanResult result = bus_.Send(UnpackFrame(to_controller_.Next(now)));
    if (result != CanResult::kOk) return result;
  }
  return CanResult::kOk;
}

CanResult ImpairedCanBus::Send(const io::CanFrame& frame) OSTEON_RT {
  if (!IsOfWire(frame)) return bus_.Send(frame);
  const rt::Nanoseconds now = Now();
  Bytes bytes;
  to_controller_.Push(PackFrame(frame, bytes), now);
  return SendDue(now);
}

// Pushes a frame that the underlying bus has received into the wire. Returns false if the frame's identifier
// is not one of the wire's.
bool ImpairedCanBus::AcceptArrival(const io::CanArrival& arrival) OSTEON_RT {
  if (!IsOfWire(arrival.frame)) return false;
  gap_ |= arrival.after_gap;
  Bytes bytes;
  from_controller_.Push(PackFrame(arrival.frame, bytes), arrival.stamp);
  return true;
}

bool ImpairedCanBus::DeliverDue(rt::Nanoseconds now, io::CanArrival& arrival) OSTEON_RT {
  const rt::Nanoseconds due = from_controller_.NextDue();
  if (due > now) return false;
  arrival = {.frame = UnpackFrame(from_controller_.Next(now)),
             .stamp = due,
             .after_gap = std::exchange(gap_, false)};
  return true;
}

CanResult ImpairedCanBus::TryReceive(io::CanArrival& arrival) OSTEON_RT {
  const rt::Nanoseconds now = Now();
  static_cast<void>(SendDue(now));
  io::CanArrival came;
  for (int i = 0; i < kMaxReads; ++i) {
    const CanResult result = bus_.TryReceive(came);
    if (result == CanResult::kDown) return result;
    if (result != CanResult::kOk) break;
    if (!AcceptArrival(came)) {
      arrival = came;
      return CanResult::kOk;
    }
  }
  return DeliverDue(now, arrival) ? CanResult::kOk : CanResult::kEmpty;
}

CanResult ImpairedCanBus::Receive(io::CanArrival& arrival, rt::Nanoseconds deadline) OSTEON_RT {
  for (;;) {
    const CanResult result = TryReceive(arrival);
    if (result != CanResult::kEmpty) return result;
    const rt::Nanoseconds due = std::min(to_controller_.NextDue(), from_controller_.NextDue());
    io::CanArrival came;
    const CanResult waited = bus_.Receive(came, std::min(deadline, due));
    if (waited == CanResult::kDown) return waited;
    if (waited == CanResult::kOk && !AcceptArrival(came)) {
      arrival = came;
      return waited;
    }
    if (waited != CanResult::kOk && Now() < due)
      return CanResult::kEmpty;  // the deadline passed before a frame was due, or time is virtual
  }
}

}  // namespace osteon::hil
