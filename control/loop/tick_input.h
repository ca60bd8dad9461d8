#pragma once

#include "base/marker.h"
#include "control/ports.h"
#include "control/tick_record.h"
#include "simulation/contact/contact_model.h"

// Writes the inputs of a tick into its record and reads them back, so that a replay gives the loop the same.

namespace osteon::control {

/// Collects all of a tick's arguments that its record does not hold elsewhere.
/// @param stop  an orderly stop was requested
[[nodiscard]] TickInput MakeTickInput(const ArmState& state, ReceiveResult received,
                                      const CellReadings& readings, const simulation::ContactModel& model,
                                      rt::Nanoseconds now, bool stop) OSTEON_RT;

/// Restores the arm's message of a tick.
[[nodiscard]] ArmState ArmStateOf(const TickRecord& tick) OSTEON_RT;

/// Restores the devices' readings of a tick.
[[nodiscard]] CellReadings CellReadingsOf(const TickInput& input) OSTEON_RT;

}  // namespace osteon::control
