#include "studies/faults/fault_case.h"

namespace osteon::studies {

const char* NameOf(Reaction reaction) {
  switch (reaction) {
    case Reaction::kGoesOn:
      return "goes on";
    case Reaction::kWaits:
      return "does not begin";
    case Reaction::kStops:
      return "stops";
    case Reaction::kFaults:
      return "is a fault at rest";
    case Reaction::kBacksOff:
      return "waits anew";
    case Reaction::kPauses:
      return "rests on its way";
    case Reaction::kAlignsOn:
      return "to the start, renders nothing";
    case Reaction::kBrakesOn:
      return "brakes on";
    case Reaction::kRests:
      return "stays at rest";
  }
  return "unknown";
}

Expected FaultCase::ExpectedIn(safety::CellState state) const {
  using safety::CellState;
  switch (state) {
    case CellState::kOff:
    case CellState::kChecking:
    case CellState::kReady:
    case CellState::kRecovery:
      return waiting;
    case CellState::kAligning:
      return aligning;
    case CellState::kHaptic:
    case CellState::kCutting:
      return rendering;
    case CellState::kPaused:
      return paused;
    case CellState::kStop1:
      return stop1;
    case CellState::kStop2:
      return stop2;
    case CellState::kStop0:
    case CellState::kFault:
      break;
  }
  return {.reaction = Reaction::kRests};
}

}  // namespace osteon::studies
