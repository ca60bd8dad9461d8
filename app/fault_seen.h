#pragma once

#include <string>

#include "control/tick_record.h"
#include "safety/fault.h"

namespace osteon::app {

/// What was seen when a fault was latched, with its figures, e.g. "the PLC's registers are too old: 104 ms",
/// where a tick's record tells it; else empty.
/// @param tick  the first one that has the fault
[[nodiscard]] std::string SeenAt(safety::Fault fault, const control::TickRecord& tick);

}  // namespace osteon::app
