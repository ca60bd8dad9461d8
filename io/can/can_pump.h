#pragma once

#include <array>
#include <cstddef>

#include "control/rt/clock.h"
#include "control/rt/marker.h"
#include "io/can/can_bus.h"

namespace osteon::io {

/// One device of a bus as its client sees it, all of it but the bus: frames in, frames out. Wall time drives
/// it through a CanPump, virtual time through memory. One thread at a time; no allocation.
class CanClient {
 public:
  virtual ~CanClient() = default;
  /// A frame of the bus, whoever it is meant for.
  virtual void Accept(const CanArrival& arrival) OSTEON_RT = 0;
  /// The next frame that this client wants to send at `now`; false where there is none.
  virtual bool Next(rt::Nanoseconds now, CanFrame& frame) OSTEON_RT = 0;
};

/// Carries frames between one bus and the clients that share it: once a tick, never waiting.
class CanPump {
 public:
  static constexpr std::size_t kMaxClients = 4;
  static constexpr std::size_t kMaxReads = 128;  ///< of one call: a flood must not hold the tick
  static constexpr std::size_t kMaxSends = 16;   ///< of one client in one call

  explicit CanPump(CanBus& bus) : bus_(bus) {}

  /// False where there are kMaxClients already. The client must outlive the pump.
  bool Add(CanClient& client) {
    if (count_ == kMaxClients) return false;
    clients_[count_++] = &client;
    return true;
  }

  /// Hands on what has arrived, then sends what is due: a call of ReceiveAll, and one of SendAll where
  /// anything is due. kDown where the bus is; a frame that finds no room in the queue is counted
  /// (CanStatus::unsent) and forgotten: every client repeats what matters.
  CanResult Pump(rt::Nanoseconds now) OSTEON_RT;

 private:
  CanBus& bus_;
  std::array<CanClient*, kMaxClients> clients_{};
  std::size_t count_{0};
  std::array<CanArrival, kMaxReads> arrived_{};  // scratch of a call
  std::array<CanFrame, kMaxClients * kMaxSends> due_{};
};

}  // namespace osteon::io
