#pragma once

#include <array>
#include <cstddef>

#include "base/clock.h"
#include "base/marker.h"
#include "io/can/can_bus.h"

namespace osteon::io {

/// Interface of a client (or a simulated device) on a CAN bus, without the bus itself: it accepts and
/// produces frames. In wall time a CanPump transfers the frames between client and bus; in virtual time they
/// are passed in memory. One thread at a time; no allocation.
class CanClient {
 public:
  virtual ~CanClient() = default;
  /// Accepts a frame from the bus. The frame may be for another device.
  virtual void Accept(const CanArrival& arrival) OSTEON_RT = 0;
  /// Returns in `frame` the next frame that this client sends at `now`; false if there is none.
  virtual bool Next(rt::Nanoseconds now, CanFrame& frame) OSTEON_RT = 0;
};

/// Transfers frames between a bus and the clients that share it, once per tick, without waiting.
class CanPump {
 public:
  static constexpr std::size_t kMaxClients = 4;
  /// Largest number of frames read in one call, so that many frames cannot delay the tick.
  static constexpr std::size_t kMaxReads = 128;
  static constexpr std::size_t kMaxSends = 16;  ///< largest number of frames sent for one client in one call

  explicit CanPump(CanBus& bus) : bus_(bus) {}

  /// Adds a client, which must outlive the pump. Returns false if there are already kMaxClients.
  bool Add(CanClient& client) {
    if (count_ == kMaxClients) return false;
    clients_[count_++] = &client;
    return true;
  }

  /// Passes the frames that have arrived to all clients, then sends the clients' frames. Calls ReceiveAll
  /// once, and SendAll once if there is a frame to send. Returns kDown if the bus is down. A frame that does
  /// not fit in the send queue is counted (CanStatus::unsent) and dropped, because every client repeats its
  /// important frames.
  CanResult Pump(rt::Nanoseconds now) OSTEON_RT;

 private:
  CanBus& bus_;
  std::array<CanClient*, kMaxClients> clients_{};
  std::size_t count_{0};
  // buffers of one call of Pump: the frames received and the frames to send
  std::array<CanArrival, kMaxReads> arrived_{};
  std::array<CanFrame, kMaxClients * kMaxSends> due_{};
};

}  // namespace osteon::io
