#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "hil/injection/impaired_wire.h"

// Shared by the tests of faults that are injected on wires: faults that last for the whole test, and a check
// of the counters.

namespace osteon::hil {

/// Injects these faults all the time, even before the schedule is started.
inline InjectionParams Always(const WireFaults& faults, Wire wire = Wire::kArm,
                              Direction direction = Direction::kBoth, std::uint64_t seed = 1) {
  return {.injections = {{.wire = wire, .direction = direction, .from_s = -1.0, .faults = faults}},
          .seed = seed};
}

/// Whether the counters account for every datagram that was pushed or duplicated.
inline bool Balances(const ImpairedWire& wire) {
  const WireCounters& n = wire.counters();
  return n.pushed + n.duplicated == n.passed + n.lost + n.silenced + n.overflow + wire.waiting();
}

}  // namespace osteon::hil
