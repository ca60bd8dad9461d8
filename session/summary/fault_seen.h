#pragma once

#include <span>
#include <string>

#include "control/setup/servo_params.h"
#include "control/tick_record.h"
#include "safety/fault.h"

namespace osteon::session {

/// Finds the first tick that has the fault; null: none does.
[[nodiscard]] const control::TickRecord* FirstWith(safety::Fault fault,
                                                   std::span<const control::TickRecord> ticks);

/// Describes what was measured when a fault was latched, e.g. "RUN_PERMITTED (974) is 0; the PLC's word: 8 ms
/// old", if the tick's record has the value; else empty.
/// @param tick  the first one that has the fault
/// @param servo  the cell's parameters, from which the accepted value is added: "the reading is 101 ms old,
///   accepted 100 ms"; null: not known
[[nodiscard]] std::string SeenAt(safety::Fault fault, const control::TickRecord& tick,
                                 const control::ServoParams* servo = nullptr);

}  // namespace osteon::session
