#pragma once

#include <array>
#include <cstddef>

#include "base/clock.h"
#include "base/marker.h"
#include "io/can/can_bus.h"

namespace osteon::io {

/// One device on a bus, seen from its client, without the bus itself: frames in, frames out. In wall time a
/// CanPump carries its frames; in virtual time they are passed in memory. One thread at a time; no
/// allocation.
class CanClient {
 public:
  virtual ~CanClient() = default;
  /// Takes a frame of the bus, even one for another device.
  virtual void Accept(const CanArrival& arrival) OSTEON_RT = 0;
  /// The next frame that this client wants to send at `now`; false if there is none.
  virtual bool Next(rt::Nanoseconds now, CanFrame& frame) OSTEON_RT = 0;
};

/// Carries frames between one bus and the clients that share it: once a tick, never waiting.
class CanPump {
 public:
  static constexpr std::size_t kMaxClients = 4;
  static constexpr std::size_t kMaxReads = 128;  ///< frames read in one call: a flood cannot hold up the tick
  static constexpr std::size_t kMaxSends = 16;   ///< frames sent for one client in one call

  explicit CanPump(CanBus& bus) : bus_(bus) {}

  /// False if there are already kMaxClients. The client must outlive the pump.
  bool Add(CanClient& client) {
    if (count_ == kMaxClients) return false;
    clients_[count_++] = &client;
    return true;
  }

  /// Distributes the frames that have arrived, then sends those due: one call of ReceiveAll, and one of
  /// SendAll if anything is due. kDown if the bus is down. A frame without room in the queue is counted
  /// (CanStatus::unsent) and dropped: every client repeats what matters.
  CanResult Pump(rt::Nanoseconds now) OSTEON_RT;

 private:
  CanBus& bus_;
  std::array<CanClient*, kMaxClients> clients_{};
  std::size_t count_{0};
  // scratch of one call of Pump: the frames received and the frames to send
  std::array<CanArrival, kMaxReads> arrived_{};
  std::array<CanFrame, kMaxClients * kMaxSends> due_{};
};

}  // namespace osteon::io
