#pragma once

#include <cstdint>
#include <vector>

#include "hil/injection/impaired_wire.h"
#include "io/can/can_bus.h"

namespace osteon::hil {

/// The simulated device's end of a CAN bus, with what a scenario does to its frames: those that the device
/// sends (to the controller) and those that it receives (from it).
///
/// A frame's identifier is never damaged, its data and size may be. Frames move whenever this bus is called;
/// Receive() wakes where one is due. As a device would not know of it, Send() says kOk for a frame that is
/// lost.
///
/// Several devices on one bus: wrap it once for each, with the identifiers that are its wire's; others pass
/// as they are.
class ImpairedCanBus final : public io::CanBus {
 public:
  /// @param bus  must outlive this  @param frames  the wire's identifiers; none: all
  /// @param virtual_now  where time is virtual: what it is, read at each call; outlives this. Null:
  /// CLOCK_MONOTONIC
  /// @throws std::invalid_argument from Validate(params).
  ImpairedCanBus(io::CanBus& bus, const InjectionParams& params, Wire wire,
                 std::vector<io::CanFilter> frames = {}, const rt::Nanoseconds* virtual_now = nullptr);

  /// COMMANDING_ACTIVE is seen at `now`; later calls change nothing.
  void Begin(rt::Nanoseconds now) OSTEON_RT;

  io::CanResult Send(const io::CanFrame& frame) OSTEON_RT override;
  io::CanResult TryReceive(io::CanArrival& arrival) OSTEON_RT override;
  io::CanResult Receive(io::CanArrival& arrival, rt::Nanoseconds deadline) OSTEON_RT override;
  /// Of the bus behind: what was lost on purpose is in the wires' counters.
  [[nodiscard]] const io::CanStatus& status() const OSTEON_RT override { return bus_.status(); }

  [[nodiscard]] const WireCounters& to_controller() const OSTEON_RT { return to_controller_.counters(); }
  [[nodiscard]] const WireCounters& from_controller() const OSTEON_RT { return from_controller_.counters(); }

 private:
  [[nodiscard]] rt::Nanoseconds Now() const OSTEON_RT {
    return virtual_now_ ? *virtual_now_ : rt::MonotonicNow();
  }
  [[nodiscard]] bool IsOfWire(const io::CanFrame& frame) const OSTEON_RT;
  io::CanResult SendDue(rt::Nanoseconds now) OSTEON_RT;
  [[nodiscard]] bool TakeIn(const io::CanArrival& arrival) OSTEON_RT;
  [[nodiscard]] bool TakeDue(rt::Nanoseconds now, io::CanArrival& arrival) OSTEON_RT;

  io::CanBus& bus_;
  std::vector<io::CanFilter> frames_;
  const rt::Nanoseconds* virtual_now_;
  ImpairedWire to_controller_, from_controller_;
  bool gap_{false};  // the bus behind knows of a loss
};

}  // namespace osteon::hil
