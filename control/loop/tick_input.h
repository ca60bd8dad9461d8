#pragma once

#include "base/marker.h"
#include "control/ports.h"
#include "control/tick_record.h"
#include "simulation/contact/contact_model.h"

// Conversion between a tick's inputs and its record, so that a replay can give the loop the same inputs
// again.

namespace osteon::control {

/// Collects those of a tick's inputs that the rest of the record does not hold.
/// @param stop  whether an orderly stop was requested
[[nodiscard]] TickInput MakeTickInput(const ArmState& state, ReceiveResult received,
                                      const CellReadings& readings, const simulation::ContactModel& model,
                                      rt::Nanoseconds now, bool stop) OSTEON_RT;

/// Restores the arm's message from a tick's record.
[[nodiscard]] ArmState ArmStateOf(const TickRecord& tick) OSTEON_RT;

/// Restores the devices' readings from a tick's inputs.
[[nodiscard]] CellReadings CellReadingsOf(const TickInput& input) OSTEON_RT;

}  // namespace osteon::control
