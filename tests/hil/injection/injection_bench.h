#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "hil/injection/impaired_wire.h"

// Shared by the tests of injected faults on the wires: faults that last, and a check of the counters.

namespace osteon::hil {

/// Injects the same faults all the time, even before the schedule starts.
inline InjectionParams Always(const WireFaults& faults, Wire wire = Wire::kArm,
                              Direction direction = Direction::kBoth, std::uint64_t seed = 1) {
  return {.injections = {{.wire = wire, .direction = direction, .from_s = -1.0, .faults = faults}},
          .seed = seed};
}

/// Whether the counters account for every pushed datagram.
inline bool Balances(const ImpairedWire& wire) {
  const WireCounters& n = wire.counters();
  return n.pushed + n.duplicated == n.passed + n.lost + n.silenced + n.overflow + wire.waiting();
}

}  // namespace osteon::hil
