#pragma once

#include <span>
#include <string>

#include "hil/faults/fault_rig.h"
#include "safety/fault.h"

namespace osteon::hil {

/// What the cell has to make of a fault. Nothing is ignored: that it goes on is a claim as well.
enum class Reaction : std::uint8_t {
  kGoesOn,    ///< within every limit, and no fault
  kWaits,     ///< does not begin, has no fault, and begins once it is over
  kStops,     ///< latches the fault, comes to rest by the category, stays there
  kFaults,    ///< latches the fault at rest, does not move
  kBacksOff,  ///< leaves its way, waits anew, and begins again once it is over
  kPauses,    ///< rests on its way, and goes on along it once it is over
  kAlignsOn,  ///< goes on to the start, and renders nothing before it is over
  kBrakesOn,  ///< brakes on to the end of the stop that is under way
  kRests,     ///< stays at rest
};
inline constexpr int kReactions = 9;
/// @returns e.g. "does not begin"
[[nodiscard]] const char* NameOf(Reaction reaction);

struct Expected {
  Reaction reaction{Reaction::kGoesOn};
  safety::FaultSet faults{};  ///< of these at least one is latched, and no other
  int ticks{0};               ///< from the injection's first tick to the latching, at most
  safety::StopCategory stop{safety::StopCategory::kStop1};
};

/// One fault: what is injected, for how long, and what it must come to in each state. In the states of stop 0
/// and fault the cell rests, whatever else happens: kRests.
struct FaultCase {
  std::string name;      ///< "force sensor silent"
  std::string injected;  ///< "no reading any more"
  RigInjection inject;
  int lasts{300};  ///< ticks
  Expected waiting, aligning, rendering, paused, stop1, stop2;

  [[nodiscard]] Expected In(safety::CellState state) const;
};

/// All of them.
[[nodiscard]] std::span<const FaultCase> FaultCases();

}  // namespace osteon::hil
