#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/marker.h"
#include "io/can/can_bus.h"

namespace osteon::io {

/// Why a call received no message.
enum class EmptyReceive : std::uint8_t {
  kNothing,  ///< nothing waits
  kDown,     ///< the bus is down
  kReport,   ///< report about an earlier frame: another message may wait
};

/// CanBus::ReceiveAll over a batch: as few system calls as the room allows, in the order of arrival.
/// @param max_skipped  largest number of messages skipped in one call because they are not deliverable
///   frames
/// @param classify  () → EmptyReceive, by errno
/// @param deliver  (message, CanArrival&) → whether it is delivered
template <class Batch, class Classify, class Deliver>
CanResult ReceiveBatches(Batch& batch, int socket, std::size_t max_skipped, std::span<CanArrival> room,
                         std::size_t& count, const Classify& classify, const Deliver& deliver) OSTEON_RT {
  count = 0;
  std::size_t left = room.size() + max_skipped;
  while (count < room.size() && left > 0) {
    const std::size_t asked = std::min({room.size() - count, left, batch.kMax});
    const int taken = batch.Receive(socket, asked);
    if (taken <= 0) {
      const EmptyReceive why = classify();
      if (why == EmptyReceive::kDown) return CanResult::kDown;
      if (why == EmptyReceive::kNothing) break;
      --left;
      continue;
    }
    const auto came = static_cast<std::size_t>(taken);
    left -= came;
    for (std::size_t i = 0; i < came; ++i)
      if (deliver(i, room[count])) ++count;
    if (came < asked) break;  // nothing more waits
  }
  return count > 0 ? CanResult::kOk : CanResult::kEmpty;
}

}  // namespace osteon::io
