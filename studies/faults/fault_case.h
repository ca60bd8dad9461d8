#pragma once

#include <span>
#include <string>

#include "safety/fault.h"
#include "studies/faults/fault_rig.h"

namespace osteon::studies {

/// The reaction that is required of the cell after a fault is injected. A fault that the cell must tolerate
/// has a required reaction, too: kGoesOn.
enum class Reaction : std::uint8_t {
  kGoesOn,    ///< continues within every limit, without a fault
  kWaits,     ///< does not begin, latches no fault, and begins once the injection is over
  kStops,     ///< latches the fault, stops by the required stop category, stays stopped
  kFaults,    ///< latches the fault at rest, does not move
  kBacksOff,  ///< leaves the start path, waits again, and begins once the injection is over
  kPauses,    ///< pauses on the start path, and continues once the injection is over
  kAlignsOn,  ///< continues on the start path, and renders nothing until the injection is over
  kBrakesOn,  ///< continues to brake until the stop that had begun ends
  kRests,     ///< stays at rest
};
/// @returns e.g. "does not begin"
[[nodiscard]] const char* NameOf(Reaction reaction);

/// A required reaction with its bounds.
struct Expected {
  Reaction reaction{Reaction::kGoesOn};
  safety::FaultSet faults{};  ///< at least one of these faults must be latched, and no other fault
  int ticks{0};               ///< maximum number of ticks from the injection to the latching
  safety::StopCategory stop{safety::StopCategory::kStop1};
};

/// One fault: what is injected, for how long, and the required reaction in each state. In stop 0 and in fault
/// the cell always stays at rest (kRests), so these states have no member.
struct FaultCase {
  std::string name;      ///< "force sensor silent"
  std::string injected;  ///< "no reading any more"
  RigInjection inject;
  int lasts{300};  ///< duration of the injection [ticks]
  /// The required reactions, by the state in which the injection begins; `waiting` is for every state before
  /// motion.
  Expected waiting, aligning, rendering, paused, stop1, stop2;

  [[nodiscard]] Expected ExpectedIn(safety::CellState state) const;
};

/// All fault cases.
[[nodiscard]] std::span<const FaultCase> FaultCases();

}  // namespace osteon::studies
