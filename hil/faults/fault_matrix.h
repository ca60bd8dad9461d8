#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "hil/faults/fault_case.h"

namespace osteon::hil {

/// What a fault came to in a state.
struct FaultVerdict {
  std::string fault;  ///< FaultCase::name
  safety::CellState state{safety::CellState::kOff};
  Expected expected{};
  safety::FaultSet latched{};
  int ticks{-1};           ///< from the injection (where the cell waited: from the hand-over) to the latching
  double distance_m{0.0};  ///< of the commanded tool, from there to rest
  double most_distance_m{0.0};  ///< stated: v^2 / 2a and a tick's way; on the way to the start, the clock's
  double peak_force_N{0.0};     ///< rendered, over all of it
  std::string wrong;            ///< empty: as expected

  [[nodiscard]] bool passed() const { return wrong.empty(); }
};

/// One fault in one state, in virtual time. Beside what is expected of the two, in every tick: the rendered
/// force and each commanded joint's speed within their limits, every command finite, the recording without a
/// gap; nothing moves while it is not to; and afterwards a recovery goes on where the faults allow one, is
/// refused where not, and a new run begins in either case.
[[nodiscard]] FaultVerdict RunFault(const FaultCase& fault, safety::CellState state);

/// Every fault in every state.
/// @param progress told the share that is done, 0 … 1; may be empty; false: stop early
[[nodiscard]] std::vector<FaultVerdict> RunFaultMatrix(std::span<const FaultCase> faults,
                                                       const std::function<bool(double)>& progress = {});

}  // namespace osteon::hil
