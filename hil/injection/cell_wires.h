#pragma once

#include "hil/injection/impaired_wire.h"

namespace osteon::hil {

/// What was injected into a simulated arm's wire. Plain data.
struct CellWireCounters {
  WireCounters arm_to_controller, arm_from_controller;
};

/// The wire between a SimulatedCell and its client: FRI or RSI both ways. Both clocks use it. One thread at a
/// time; no allocation once made.
class CellWires {
 public:
  /// @throws std::invalid_argument from Validate(params).
  explicit CellWires(const InjectionParams& params);

  /// COMMANDING_ACTIVE is seen at `now`; later calls change nothing.
  void Begin(rt::Nanoseconds now) OSTEON_RT;

  ImpairedWire to_controller;    ///< of the arm
  ImpairedWire from_controller;  ///< has room for a datagram that is too long, so that it shows as such

  [[nodiscard]] CellWireCounters counters() const OSTEON_RT {
    return {to_controller.counters(), from_controller.counters()};
  }
  /// Whether anything is ever done to either of them.
  [[nodiscard]] bool injects() const { return to_controller.injects() || from_controller.injects(); }
};

}  // namespace osteon::hil
