#include "safety/cell_state.h"

#include <algorithm>
#include <cstddef>
#include <iterator>

namespace osteon::safety {
namespace {

using enum CellState;
using Event = CellEvent;
using Action = CellAction;

// One transition of the table.
struct Rule {
  CellState from;
  CellEvent event;
  CellState to;
  CellAction action;
};

// Every transition of the table. Any other event leaves the state unchanged and asks for no action (kNone).
constexpr Rule kRules[] = {
    {kOff, Event::kArmLost, kFault, Action::kHold},
    {kOff, Event::kFault, kFault, Action::kHold},
    {kOff, Event::kPauseRequested, kPaused, Action::kHold},
    {kOff, Event::kArmSeen, kChecking, Action::kFollowArm},

    {kChecking, Event::kArmLost, kFault, Action::kHold},
    {kChecking, Event::kFault, kFault, Action::kHold},
    {kChecking, Event::kStopRequested, kOff, Action::kHold},
    {kChecking, Event::kPauseRequested, kPaused, Action::kHold},
    {kChecking, Event::kArmIdle, kOff, Action::kFollowArm},
    {kChecking, Event::kPermitsHold, kReady, Action::kNone},

    {kReady, Event::kArmLost, kFault, Action::kHold},
    {kReady, Event::kFault, kFault, Action::kHold},
    {kReady, Event::kStopRequested, kOff, Action::kHold},
    {kReady, Event::kPauseRequested, kPaused, Action::kHold},
    {kReady, Event::kArmIdle, kOff, Action::kFollowArm},
    {kReady, Event::kPermitsMissing, kChecking, Action::kNone},
    {kReady, Event::kBeginAligning, kAligning, Action::kBeginPath},
    {kReady, Event::kBeginRendering, kHaptic, Action::kBeginRendering},

    {kAligning, Event::kArmLost, kStop0, Action::kHold},
    {kAligning, Event::kFault, kStop1, Action::kBrake},
    {kAligning, Event::kArmLeft, kChecking, Action::kFollowArm},
    {kAligning, Event::kStopRequested, kStop1, Action::kBrake},
    {kAligning, Event::kPauseRequested, kStop2, Action::kBrake},
    {kAligning, Event::kBeginRendering, kHaptic, Action::kBeginRendering},

    {kHaptic, Event::kArmLost, kStop0, Action::kHold},
    {kHaptic, Event::kFault, kStop1, Action::kBrake},
    {kHaptic, Event::kArmLeft, kStop0, Action::kFollowArm},
    {kHaptic, Event::kStopRequested, kStop1, Action::kBrake},
    {kHaptic, Event::kPauseRequested, kStop2, Action::kBrake},
    {kHaptic, Event::kSpindleTurns, kCutting, Action::kNone},

    {kCutting, Event::kArmLost, kStop0, Action::kHold},
    {kCutting, Event::kFault, kStop1, Action::kBrake},
    {kCutting, Event::kArmLeft, kStop0, Action::kFollowArm},
    {kCutting, Event::kStopRequested, kStop1, Action::kBrake},
    {kCutting, Event::kPauseRequested, kStop2, Action::kBrake},
    {kCutting, Event::kSpindleStill, kHaptic, Action::kNone},

    {kPaused, Event::kArmLost, kFault, Action::kHold},
    {kPaused, Event::kFault, kFault, Action::kHold},
    {kPaused, Event::kStopRequested, kOff, Action::kHold},
    {kPaused, Event::kResume, kChecking, Action::kNone},

    {kStop0, Event::kRestFault, kFault, Action::kHold},
    {kStop0, Event::kRest, kOff, Action::kHold},
    {kStop0, Event::kRecover, kRecovery, Action::kClearFaults},

    {kStop1, Event::kArmLost, kStop0, Action::kHold},
    {kStop1, Event::kArmLeft, kStop0, Action::kFollowArm},
    {kStop1, Event::kRestFault, kFault, Action::kHold},
    {kStop1, Event::kRest, kOff, Action::kHold},

    {kStop2, Event::kArmLost, kStop0, Action::kHold},
    {kStop2, Event::kFault, kStop1, Action::kBrake},
    {kStop2, Event::kArmLeft, kStop0, Action::kFollowArm},
    {kStop2, Event::kStopRequested, kStop1, Action::kBrake},
    {kStop2, Event::kRestFault, kFault, Action::kHold},
    {kStop2, Event::kRest, kPaused, Action::kHold},

    {kFault, Event::kRecover, kRecovery, Action::kClearFaults},

    {kRecovery, Event::kArmLost, kFault, Action::kHold},
    {kRecovery, Event::kFault, kFault, Action::kHold},
    {kRecovery, Event::kStopRequested, kOff, Action::kHold},
    {kRecovery, Event::kPauseRequested, kPaused, Action::kHold},
    {kRecovery, Event::kBeginAligning, kAligning, Action::kBeginPath},
    {kRecovery, Event::kBeginRendering, kHaptic, Action::kBeginRendering},
};

constexpr std::size_t IndexOf(CellState state) { return static_cast<std::size_t>(state); }
constexpr std::size_t IndexOf(CellEvent event) { return static_cast<std::size_t>(event); }

// Makes the whole table: an event leaves a state unchanged unless a rule says otherwise.
constexpr CellTable MakeTable() {
  CellTable table{};
  for (std::size_t s = 0; s < table.size(); ++s)
    for (CellTransition& cell : table[s])
      cell = {.state = static_cast<CellState>(s), .action = Action::kNone};
  for (const Rule& rule : kRules)
    table[IndexOf(rule.from)][IndexOf(rule.event)] = {.state = rule.to, .action = rule.action};
  return table;
}
constexpr CellTable kTable = MakeTable();

// Whether holds(state, event, transition) is true for every entry of the table.
template <class Holds>
constexpr bool HoldsForAllTransitions(Holds&& holds) {
  for (std::size_t s = 0; s < kTable.size(); ++s)
    for (std::size_t e = 0; e < kTable[s].size(); ++e)
      if (!holds(static_cast<CellState>(s), static_cast<CellEvent>(e), kTable[s][e])) return false;
  return true;
}

// Whether no two rules are for the same state and event.
constexpr bool IsEachRuleUnique() {
  for (std::size_t i = 0; i < std::size(kRules); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (kRules[i].from == kRules[j].from && kRules[i].event == kRules[j].event) return false;
  return true;
}
static_assert(IsEachRuleUnique());

// From a state of rest, only kBeginAligning and kBeginRendering lead to motion. The caller raises these two
// events only when every condition of motion holds.
static_assert(HoldsForAllTransitions([](CellState from, CellEvent event, CellTransition to) {
  if (!IsMotion(to.state) || IsMotion(from)) return true;
  return (event == Event::kBeginAligning && to.action == Action::kBeginPath && to.state == kAligning) ||
         (event == Event::kBeginRendering && to.action == Action::kBeginRendering && to.state == kHaptic);
}));
// Between states of motion: only kBeginRendering leads from aligning to haptic, and only the spindle's start
// and stop change between haptic and cutting.
static_assert(HoldsForAllTransitions([](CellState from, CellEvent event, CellTransition to) {
  if (!IsMotion(from) || !IsMotion(to.state) || from == to.state) return true;
  if (from == kAligning) return event == Event::kBeginRendering && to.action == Action::kBeginRendering;
  return Renders(to.state) && (event == Event::kSpindleTurns || event == Event::kSpindleStill);
}));
// A fault ends every motion. If the arm takes commands, it brakes. If the arm is lost, the last command is
// held, which has no effect on the arm.
static_assert(HoldsForAllTransitions([](CellState from, CellEvent event, CellTransition to) {
  const bool moves = IsMotion(from) || from == kStop2;
  if (moves && event == Event::kFault) return to == CellTransition{kStop1, Action::kBrake};
  if ((moves || from == kStop1) && event == Event::kArmLost)
    return to == CellTransition{kStop0, Action::kHold};
  return true;
}));
// A requested stop or pause ends every motion too.
static_assert(HoldsForAllTransitions([](CellState from, CellEvent event, CellTransition to) {
  if (!IsMotion(from)) return true;
  if (event == Event::kStopRequested) return to == CellTransition{kStop1, Action::kBrake};
  if (event == Event::kPauseRequested) return to == CellTransition{kStop2, Action::kBrake};
  return true;
}));
// A stop becomes more severe or ends at rest; it never turns into motion or into a less severe stop.
static_assert(HoldsForAllTransitions([](CellState from, CellEvent event, CellTransition to) {
  if (!IsStop(from) || to.state == from) return true;
  if (IsStop(to.state)) return IndexOf(to.state) < IndexOf(from);  // stop 0 is the most severe
  if (from == kStop0 && event == Event::kRecover) return to.state == kRecovery;
  return event == Event::kRest        ? to.state == (from == kStop2 ? kPaused : kOff)
         : event == Event::kRestFault ? to.state == kFault
                                      : false;
}));
// Only a recovery leads out of kFault, and only a recovery clears faults.
static_assert(HoldsForAllTransitions([](CellState from, CellEvent event, CellTransition to) {
  if (to.action == Action::kClearFaults) return event == Event::kRecover && to.state == kRecovery;
  return from != kFault || to.state == kFault;
}));

}  // namespace

const CellTable kCellTable = kTable;

CellTransition Next(CellState state, CellEvent event) OSTEON_RT {
  return kTable[IndexOf(state)][IndexOf(event)];
}

CellStateText Describe(CellState state) {
  switch (state) {
    case kOff:
      return {"off", "commands nothing; follows an arm that says where it is",
              "start the arm's program; after an orderly end, a new run"};
    case kChecking:
      return {"checking", "follows the arm, looks at the conditions of motion",
              "by itself once every condition holds; `osteon run` names those that do not"};
    case kReady:
      return {"ready", "follows the arm, looks at the conditions of motion",
              "by itself once the robot's program hands the arm over (COMMANDING_ACTIVE)"};
    case kAligning:
      return {"aligning", "moves along the path to the start; rests on it while motion is not permitted",
              "by itself at the path's end, once every condition holds"};
    case kHaptic:
      return {"haptic", "renders, the spindle still", "the pedal; a pause, a stop"};
    case kCutting:
      return {"cutting", "renders, the spindle turns", "the pedal; a pause, a stop"};
    case kPaused:
      return {"paused", "holds under power, the spindle still; looks at the conditions of motion",
              "`osteon resume`, or Resume in the console: begins anew where it stands, once every condition "
              "holds"};
    case kStop0:
      return {"stop 0",
              "sends the last command on, which counts for nothing; follows an arm that moves by itself",
              "by itself, once the arm is seen to stand; `osteon recover` where the fault allows one"};
    case kStop1:
      return {"stop 1", "brakes what is commanded, renders nothing, stills the spindle, asks for no motion",
              "by itself, at rest"};
    case kStop2:
      return {"stop 2", "brakes what is commanded, renders nothing, stills the spindle; supervises on",
              "by itself, at rest"};
    case CellState::kFault:
      return {"fault", "holds, and follows an arm that moves by itself; asks for no motion",
              "`osteon recover`, or Recover in the console, where each fault allows one; else a new run"};
    case kRecovery:
      return {"recovery", "follows the arm, or holds where it never left; the spindle's drive may be cleared",
              "by itself once every condition holds"};
  }
  return {"unknown", "nothing", "a new run"};
}

CellEventText Describe(CellEvent event) {
  switch (event) {
    case Event::kArmLost:
      return {"arm lost",
              "it can not be commanded: silent, closed, of another period or command mode; latched"};
    case Event::kFault:
      return {"fault", "a fault is latched, and the arm takes commands"};
    case Event::kArmLeft:
      return {"arm left", "a message of the arm says that it is not in COMMANDING_ACTIVE"};
    case Event::kStopRequested:
      return {"stop asked", "an orderly end: Ctrl-C, or the run's time is over; lasts"};
    case Event::kPauseRequested:
      return {"pause asked", "`osteon pause`, Pause in the console, SIGUSR1"};
    case Event::kRestFault:
      return {"rest, fault", "what is commanded rests (stop 0: the arm is measured to stand), with a fault"};
    case Event::kRest:
      return {"rest", "the same, without a fault"};
    case Event::kArmIdle:
      return {"arm idle", "a message of the arm does not say where it is"};
    case Event::kArmSeen:
      return {"arm seen", "a message of the arm says where it is"};
    case Event::kPermitsMissing:
      return {"not in order", "a condition of motion does not hold, the handing over apart"};
    case Event::kPermitsHold:
      return {"in order", "every condition of motion holds, the handing over apart"};
    case Event::kBeginAligning:
      return {"begin, away", "every condition of motion holds; the start is elsewhere"};
    case Event::kBeginRendering:
      return {"begin, there", "every condition of motion holds; at the start, or rendering was begun before"};
    case Event::kSpindleTurns:
      return {"spindle turns", "at more than a twentieth of what is wanted, measured where there is a drive"};
    case Event::kSpindleStill:
      return {"spindle still", "it does not"};
    case Event::kRecover:
      return {"recovery asked", "and each latched fault allows one (docs/faults.md)"};
    case Event::kResume:
      return {"resume asked", "`osteon resume`, Resume in the console, SIGUSR2"};
  }
  return {"unknown", "never"};
}

const char* NameOf(CellAction action) {
  switch (action) {
    case Action::kNone:
      return "goes on";
    case Action::kFollowArm:
      return "follows the arm";
    case Action::kHold:
      return "holds";
    case Action::kBrake:
      return "brakes";
    case Action::kBeginPath:
      return "begins the path";
    case Action::kBeginRendering:
      return "begins to render";
    case Action::kClearFaults:
      return "clears the faults";
  }
  return "unknown";
}

}  // namespace osteon::safety
