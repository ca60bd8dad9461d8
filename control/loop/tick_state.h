#pragma once

#include "control/ports.h"
#include "control/tick_record.h"
#include "safety/cell_state.h"

// Interprets the state numbers in a recorded tick.

namespace osteon::control {

/// Whether the operator has paused the cell.
[[nodiscard]] inline bool IsPaused(const TickRecord& tick) {
  return tick.cell_state == static_cast<std::uint8_t>(safety::CellState::kPaused);
}

/// Whether the tick had a message from the arm. A tick without a message computes and sends nothing.
[[nodiscard]] inline bool HasMessage(const TickRecord& tick) {
  return tick.input.received == static_cast<std::uint8_t>(ReceiveResult::kOk);
}

}  // namespace osteon::control
