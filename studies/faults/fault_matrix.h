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
  /// Ticks from the injection to the latching; for a cell that waited, from the hand-over of the arm.
  int ticks{-1};
  double distance_m{0.0};      ///< travel of the commanded tool from the latching of the fault to rest
  double max_distance_m{0.0};  ///< its bound: v^2 / 2a and a tick's travel; on the start path that of the
                               ///< path's clock
  double peak_force_N{0.0};    ///< rendered, over the whole run
  std::string wrong;           ///< what differed from the expected reaction; empty: nothing

  [[nodiscard]] bool passed() const { return wrong.empty(); }
};

/// Runs one fault in one state, in virtual time. In addition to the expected reaction it checks in every
/// tick: the rendered force and each commanded joint's speed are within their limits, every command is
/// finite, the recording has no gap, and nothing moves while no motion is allowed. Afterwards a recovery must
/// succeed if the faults allow one, and otherwise be refused. A new run must begin in either case.
[[nodiscard]] FaultVerdict RunFault(const FaultCase& fault, safety::CellState state);

/// Runs every fault in every state.
/// @param progress receives the share that is done, 0 … 1; may be empty; returns false to stop early
[[nodiscard]] std::vector<FaultVerdict> RunFaultMatrix(std::span<const FaultCase> faults,
                                                       const std::function<bool(double)>& progress = {});

}  // namespace osteon::studies
