#pragma once

#include "control/ports.h"
#include "hil/injection/impaired_wire.h"

namespace osteon::hil {

/// What was injected into a simulated cell's wires. Plain data.
struct CellWireCounters {
  WireCounters arm_to_controller, arm_from_controller, force_sensor;
};

/// The wires between a SimulatedCell and its client: FRI both ways, and the readings of its force sensor,
/// which are datagrams here though they are handed over in memory. Both clocks use it. One thread at a time;
/// no allocation once made.
class CellWires {
 public:
  /// @throws std::invalid_argument from Validate(params).
  explicit CellWires(const InjectionParams& params);

  /// COMMANDING_ACTIVE is seen at `now`; later calls change nothing.
  void Begin(rt::Nanoseconds now) OSTEON_RT;

  ImpairedWire to_controller;    ///< of the arm
  ImpairedWire from_controller;  ///< has room for a datagram that is too long, so that it shows as such

  void PushForce(const control::ForceReading& reading, rt::Nanoseconds now) OSTEON_RT;
  /// Puts the newest reading that is due at `now` into `reading`. A damaged one is dropped, as a sensor's
  /// checksum would see to it, and so is one that is older than `reading`. False where there is none.
  bool TakeForce(rt::Nanoseconds now, control::ForceReading& reading) OSTEON_RT;
  [[nodiscard]] rt::Nanoseconds NextForceDue() const OSTEON_RT { return force_.NextDue(); }

  [[nodiscard]] CellWireCounters counters() const OSTEON_RT {
    return {to_controller.counters(), from_controller.counters(), force_.counters()};
  }
  /// Whether anything is ever done to any of them.
  [[nodiscard]] bool injects() const {
    return to_controller.injects() || from_controller.injects() || force_.injects();
  }

 private:
  ImpairedWire force_;
};

}  // namespace osteon::hil
