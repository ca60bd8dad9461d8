#pragma once

#include "hil/injection/impaired_wire.h"

namespace osteon::hil {

/// Counters of the faults injected into a simulated arm's wire. Plain data.
struct CellWireCounters {
  WireCounters arm_to_controller, arm_from_controller;
};

/// The wire between a SimulatedCell and its client: FRI or RSI in both directions. Used in wall time and
/// virtual time. One thread at a time; no allocation after construction.
class CellWires {
 public:
  /// @throws std::invalid_argument from Validate(params).
  explicit CellWires(const InjectionParams& params);

  /// Starts the injections' schedule at `now`, the time of the first COMMANDING_ACTIVE; later calls change
  /// nothing.
  void StartSchedule(rt::Nanoseconds now) OSTEON_RT;

  ImpairedWire to_controller;    ///< carries the arm's messages
  ImpairedWire from_controller;  ///< carries the answers; has room for a datagram that exceeds the protocol's
                                 ///< length, so that the receiver can detect it

  [[nodiscard]] CellWireCounters counters() const OSTEON_RT {
    return {to_controller.counters(), from_controller.counters()};
  }
  /// Whether faults are configured for either direction.
  [[nodiscard]] bool injects() const { return to_controller.injects() || from_controller.injects(); }
};

}  // namespace osteon::hil
