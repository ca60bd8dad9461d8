#pragma once

#include <array>
#include <cstddef>

#include "io/can/can_bus.h"

namespace osteon::hil {

/// One end of a CAN bus with two ends in memory, in virtual time: a frame sent at one end can be received at
/// the other at once. One thread; no allocation.
class MemoryCanBus final : public io::CanBus {
 public:
  /// @param now  the virtual time, read at each call; must outlive this object
  explicit MemoryCanBus(const rt::Nanoseconds& now) : now_(now) {}

  /// Connects the two ends of a bus. The objects must not be moved afterwards.
  static void Join(MemoryCanBus& one, MemoryCanBus& other) {
    one.other_ = &other;
    other.other_ = &one;
  }

  io::CanResult Send(const io::CanFrame& frame) OSTEON_RT override;
  io::CanResult TryReceive(io::CanArrival& arrival) OSTEON_RT override;
  /// Same as TryReceive: it does not wait, because virtual time would not pass.
  io::CanResult Receive(io::CanArrival& arrival, rt::Nanoseconds deadline) OSTEON_RT override;
  [[nodiscard]] const io::CanStatus& status() const OSTEON_RT override { return status_; }

 private:
  const rt::Nanoseconds& now_;
  MemoryCanBus* other_{nullptr};
  std::array<io::CanArrival, 256> arrived_{};  // ring buffer of received frames
  std::size_t first_{0}, count_{0};
  io::CanStatus status_;
};

}  // namespace osteon::hil
