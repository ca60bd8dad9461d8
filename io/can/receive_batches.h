#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/marker.h"
#include "io/can/can_bus.h"

namespace osteon::io {

/// Reason why a call received no message.
enum class EmptyReceive : std::uint8_t {
  kNothing,  ///< no message waits
  kDown,     ///< the bus is down
  kReport,   ///< the call reported an error of an earlier frame: another message may wait
};

/// CanBus::ReceiveAll for a MessageBatch: receives frames in their order of arrival until `room` is full or
/// no message waits, several with each system call.
/// @param max_skipped  largest number of messages skipped in one call because they are not deliverable
///   frames
/// @param count  set to the number of frames delivered into `room`
/// @param classify  () → EmptyReceive: why a call received nothing, by errno
/// @param deliver  (index in the batch, CanArrival&) → whether that message is a frame to deliver
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
    if (came < asked) break;  // no further message waits
  }
  return count > 0 ? CanResult::kOk : CanResult::kEmpty;
}

}  // namespace osteon::io
