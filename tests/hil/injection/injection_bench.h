#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "hil/injection/impaired_wire.h"

// Shared helpers of the tests of injected faults.

namespace osteon::hil {

/// One kind of fault from the very start to the end.
inline InjectionParams Always(const WireFaults& faults, Wire wire = Wire::kArm,
                              Direction direction = Direction::kBoth, std::uint64_t seed = 1) {
  return {.injections = {{.wire = wire, .direction = direction, .from_s = -1.0, .faults = faults}},
          .seed = seed};
}

/// Every pushed datagram is accounted for.
inline bool Balances(const ImpairedWire& wire) {
  const WireCounters& n = wire.counters();
  return n.pushed + n.duplicated == n.passed + n.lost + n.silenced + n.overflow + wire.waiting();
}

}  // namespace osteon::hil
