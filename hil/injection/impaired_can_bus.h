#pragma once

#include <cstdint>
#include <vector>

#include "hil/injection/impaired_wire.h"
#include "io/can/can_bus.h"

namespace osteon::hil {

/// The simulated device's end of a CAN bus, with a scenario's faults on its frames: both on those that the
/// device sends to the controller and on those that it receives.
///
/// A frame's identifier is never damaged; its data and size may be. Delayed frames are sent and delivered
/// when a method of this bus is called; Receive() waits until one is due at the latest. Send() returns kOk
/// for a frame that is lost, because a real device would not notice the loss.
///
/// If several devices share one bus, wrap the bus once for each device, with the identifiers of that device's
/// wire. Other frames pass unchanged.
class ImpairedCanBus final : public io::CanBus {
 public:
  /// @param bus  must outlive this object  @param frames  the identifiers that belong to the wire; none: all
  /// @param virtual_now  the virtual time, read at each call; must outlive this object. Null: CLOCK_MONOTONIC
  /// @throws std::invalid_argument from Validate(params).
  ImpairedCanBus(io::CanBus& bus, const InjectionParams& params, Wire wire,
                 std::vector<io::CanFilter> frames = {}, const rt::Nanoseconds* virtual_now = nullptr);

  /// Starts the faults' schedule at `now`, the time of the first COMMANDING_ACTIVE; later calls change
  /// nothing.
  void StartSchedule(rt::Nanoseconds now) OSTEON_RT;

  io::CanResult Send(const io::CanFrame& frame) OSTEON_RT override;
  io::CanResult TryReceive(io::CanArrival& arrival) OSTEON_RT override;
  io::CanResult Receive(io::CanArrival& arrival, rt::Nanoseconds deadline) OSTEON_RT override;
  /// Status of the underlying bus; injected losses are in the wires' counters.
  [[nodiscard]] const io::CanStatus& status() const OSTEON_RT override { return bus_.status(); }

  [[nodiscard]] const WireCounters& to_controller() const OSTEON_RT { return to_controller_.counters(); }
  [[nodiscard]] const WireCounters& from_controller() const OSTEON_RT { return from_controller_.counters(); }

 private:
  [[nodiscard]] rt::Nanoseconds Now() const OSTEON_RT {
    return virtual_now_ ? *virtual_now_ : rt::MonotonicNow();
  }
  // Whether the frame's identifier is one of the wire's.
  [[nodiscard]] bool IsOfWire(const io::CanFrame& frame) const OSTEON_RT;
  // Sends those frames to the controller that are due.
  io::CanResult SendDue(rt::Nanoseconds now) OSTEON_RT;
  [[nodiscard]] bool AcceptArrival(const io::CanArrival& arrival) OSTEON_RT;
  // Returns in `arrival` the next due frame from the controller. False if there is none.
  [[nodiscard]] bool DeliverDue(rt::Nanoseconds now, io::CanArrival& arrival) OSTEON_RT;

  io::CanBus& bus_;
  std::vector<io::CanFilter> frames_;
  const rt::Nanoseconds* virtual_now_;
  ImpairedWire to_controller_, from_controller_;
  bool gap_{false};  // the underlying bus reported a loss
};

}  // namespace osteon::hil
