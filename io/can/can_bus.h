#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/clock.h"
#include "base/marker.h"
#include "io/can/frame.h"

namespace osteon::io {

enum class CanResult : std::uint8_t {
  kOk,
  kEmpty,  ///< no frame has arrived (until the deadline)
  kFull,   ///< the frame was not sent: the system's send queue is full, or no node acknowledges
  kDown,   ///< the interface is down or gone, or the CAN controller is off the bus
};

/// Counters of frames since the bus was opened, and the CAN controller's bus state.
struct CanStatus {
  std::uint64_t received{0}, sent{0};
  std::uint64_t unsent{0};  ///< frames for which Send() returned kFull or kDown
  /// Known losses of frames to this end: overflow of a queue, or a gap in the tunnel's sequence.
  std::uint64_t lost{0};
  /// Received messages that are no classical data frame with an 11-bit identifier, or no datagram of the
  /// tunnel's format.
  std::uint64_t rejected{0};
  /// UDP tunnel: frames received before, or overtaken by a newer frame; not delivered.
  std::uint64_t duplicate{0};
  std::uint64_t error_frames{0};  ///< SocketCAN: reports of the CAN controller
  bool error_warning{false}, error_passive{false}, bus_off{false};
};

/// A set of identifiers that a bus delivers: those with (identifier & mask) == (id & mask).
struct CanFilter {
  std::uint16_t id{0};
  std::uint16_t mask{kCanMaxId};
};

/// One end of a CAN bus, for one thread at a time. After the bus is opened, no method allocates, locks or
/// throws.
class CanBus {
 public:
  CanBus() = default;
  virtual ~CanBus() = default;
  CanBus(const CanBus&) = delete;
  CanBus& operator=(const CanBus&) = delete;

  /// Sends the frame at once or not at all. A frame of more than 8 bytes, or with an id of more than 11 bits,
  /// is never sent: the result is kFull.
  virtual CanResult Send(const CanFrame& frame) OSTEON_RT = 0;

  /// Sends as many of the frames as possible, in their order; counts the others (CanStatus::unsent).
  /// @returns kOk if all were sent, otherwise the most severe error.
  virtual CanResult SendAll(std::span<const CanFrame> frames) OSTEON_RT {
    CanResult result = CanResult::kOk;
    for (const CanFrame& frame : frames) result = std::max(result, Send(frame));
    return result;
  }

  /// Returns the next frame that has arrived in `arrival`; never waits.
  virtual CanResult TryReceive(CanArrival& arrival) OSTEON_RT = 0;

  /// Waits for a frame until `deadline` on CLOCK_MONOTONIC. A frame that has already arrived is returned even
  /// if the deadline has passed.
  virtual CanResult Receive(CanArrival& arrival, rt::Nanoseconds deadline) OSTEON_RT = 0;

  /// Returns the frames that have arrived, at most as many as fit in `room`; never waits.
  /// @param[out] count  number of frames, at the front of `room`
  /// @returns kEmpty if there was none; kDown if the bus is down, even after frames were taken.
  virtual CanResult ReceiveAll(std::span<CanArrival> room, std::size_t& count) OSTEON_RT {
    for (count = 0; count < room.size(); ++count) {
      const CanResult result = TryReceive(room[count]);
      if (result == CanResult::kDown) return result;
      if (result != CanResult::kOk) break;
    }
    return count > 0 ? CanResult::kOk : CanResult::kEmpty;
  }

  /// As ReceiveAll, for callers that do not distinguish a bus that is down from a silent bus. @returns the
  /// number of frames received.
  std::size_t Drain(std::span<CanArrival> room) OSTEON_RT {
    std::size_t count = 0;
    static_cast<void>(ReceiveAll(room, count));
    return count;
  }

  [[nodiscard]] virtual const CanStatus& status() const OSTEON_RT = 0;
};

}  // namespace osteon::io
