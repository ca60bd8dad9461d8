#pragma once

#include "control/ports.h"
#include "control/tick_record.h"
#include "safety/cell_state.h"

// The numbers of a recorded tick, as what they stand for.

namespace osteon::control {

/// The operator has paused the cell.
[[nodiscard]] inline bool IsPaused(const TickRecord& tick) {
  return tick.cell_state == static_cast<std::uint8_t>(safety::CellState::kPaused);
}

/// The arm's message of this tick came; without one nothing was computed and nothing sent.
[[nodiscard]] inline bool HasMessage(const TickRecord& tick) {
  return tick.input.received == static_cast<std::uint8_t>(ReceiveResult::kOk);
}

}  // namespace osteon::control
