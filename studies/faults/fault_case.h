#pragma once

#include <span>
#include <string>

#include "safety/fault.h"
#include "studies/faults/fault_rig.h"

namespace osteon::studies {

/// The cell's required reaction to a fault. Each fault has one: to go on is a requirement as well.
enum class Reaction : std::uint8_t {
  kGoesOn,    ///< within every limit, without a fault
  kWaits,     ///< does not begin, latches no fault, and begins once the injection is over
  kStops,     ///< latches the fault, stops by the category, stays there
  kFaults,    ///< latches the fault at rest, does not move
  kBacksOff,  ///< leaves its path, waits again, and begins once the injection is over
  kPauses,    ///< pauses on its path, and continues once the injection is over
  kAlignsOn,  ///< continues to the start, and renders nothing until the injection is over
  kBrakesOn,  ///< continues to brake until the stop in progress ends
  kRests,     ///< stays at rest
};
/// @returns e.g. "does not begin"
[[nodiscard]] const char* NameOf(Reaction reaction);

/// A required reaction with its bounds.
struct Expected {
  Reaction reaction{Reaction::kGoesOn};
  safety::FaultSet faults{};  ///< at least one of these faults is latched, and no other
  int ticks{0};               ///< largest number of ticks from the injection to the latching
  safety::StopCategory stop{safety::StopCategory::kStop1};
};

/// One fault: what is injected, for how long, and the required reaction in each state. In the states of stop
/// 0 and fault the cell always rests: kRests.
struct FaultCase {
  std::string name;      ///< "force sensor silent"
  std::string injected;  ///< "no reading any more"
  RigInjection inject;
  int lasts{300};  ///< ticks
  /// The reactions by the state in which the injection begins; `waiting` is for each state before motion.
  Expected waiting, aligning, rendering, paused, stop1, stop2;

  [[nodiscard]] Expected ExpectedIn(safety::CellState state) const;
};

/// All fault cases.
[[nodiscard]] std::span<const FaultCase> FaultCases();

}  // namespace osteon::studies
