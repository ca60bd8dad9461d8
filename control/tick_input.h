#pragma once

#include "control/ports.h"
#include "control/rt/marker.h"
#include "control/tick_record.h"
#include "simulation/contact_model.h"

// What a tick was given, into its record and back: a replay gives the loop the same again.

namespace osteon::control {

/// Everything of a tick's arguments that is not in its record by another name.
/// @param stop  an orderly stop had been asked for
[[nodiscard]] TickInput InputOf(const ArmState& state, ReceiveResult received, const CellReadings& readings,
                                const simulation::ContactModel& model, rt::Nanoseconds now,
                                bool stop) OSTEON_RT;

/// The arm's message as the tick had it.
[[nodiscard]] ArmState ArmStateOf(const TickRecord& tick) OSTEON_RT;

/// What the devices said, as the tick had it.
[[nodiscard]] CellReadings CellReadingsOf(const TickInput& input) OSTEON_RT;

}  // namespace osteon::control
