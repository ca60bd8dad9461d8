#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "studies/faults/fault_case.h"

namespace osteon::studies {

/// Result of one fault, injected in one state of the cell.
struct FaultVerdict {
  std::string fault;  ///< FaultCase::name
  safety::CellState state{safety::CellState::kOff};
  Expected expected{};
  safety::FaultSet latched{};
  int ticks{-1};           ///< from the injection (if the cell waited: from the hand-over) to the latching
  double distance_m{0.0};  ///< travel of the commanded tool from the latching to rest
  double max_distance_m{0.0};  ///< its bound: v^2 / 2a and a tick's travel; on the start path that of the
                               ///< path's clock
  double peak_force_N{0.0};    ///< rendered, over the whole run
  std::string wrong;           ///< empty: as expected

  [[nodiscard]] bool passed() const { return wrong.empty(); }
};

/// Runs one fault in one state, in virtual time. Beside the expected reaction it checks in every tick:
/// rendered force and each commanded joint's speed within their limits, every command finite, the recording
/// without a gap, no motion while none is allowed. Afterwards a recovery must succeed if the faults allow one
/// and be refused if not, and a new run must begin in either case.
[[nodiscard]] FaultVerdict RunFault(const FaultCase& fault, safety::CellState state);

/// Runs every fault in every state.
/// @param progress receives the share that is done, 0 … 1; may be empty; returns false to stop early
[[nodiscard]] std::vector<FaultVerdict> RunFaultMatrix(std::span<const FaultCase> faults,
                                                       const std::function<bool(double)>& progress = {});

}  // namespace osteon::studies
