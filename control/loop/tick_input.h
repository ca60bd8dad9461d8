#pragma once

#include "base/marker.h"
#include "control/ports.h"
#include "control/tick_record.h"
#include "simulation/contact/contact_model.h"

// A tick's inputs, and their conversion to and from its record, so that a replay can give the loop the same
// inputs again.

namespace osteon::control {

/// Inputs of a tick of the loop. References must outlive the tick.
struct TickInputs {
  const ArmState& state;  ///< the arm's message; used only if `received` is kOk
  ReceiveResult received{ReceiveResult::kOk};
  const CellReadings& readings;
  const simulation::ContactModel& model;  ///< newest contact model
  rt::Nanoseconds now{0};                 ///< time of the tick, on the clock of all stamps
};

/// Collects the inputs of a tick that the other fields of its record do not contain.
/// @param stop  whether an orderly stop was requested
[[nodiscard]] TickInput MakeTickInput(const TickInputs& tick, bool stop) OSTEON_RT;

/// Restores the arm's message from a tick's record.
[[nodiscard]] ArmState ArmStateOf(const TickRecord& tick) OSTEON_RT;

/// Restores the devices' readings from a tick's inputs.
[[nodiscard]] CellReadings CellReadingsOf(const TickInput& input) OSTEON_RT;

}  // namespace osteon::control
