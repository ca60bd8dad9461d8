#pragma once

#include <array>
#include <cstdint>

#include "control/rt/marker.h"

// The cell's state machine as data: one table of state × event → state, action. The servo loop lives by it,
// docs/states.md is written from it.

namespace osteon::safety {

/// What the cell is doing. The numbers are the recording's.
enum class CellState : std::uint8_t {
  kOff = 0,       ///< no arm that says where it is, or the run was ended in order
  kChecking = 1,  ///< the arm moves by itself; not every condition of motion holds (motion_permit.h)
  kReady = 2,     ///< every condition holds but that the arm is handed over
  kAligning = 3,  ///< moves to where rendering begins
  kHaptic = 4,    ///< renders, the spindle still
  kCutting = 5,   ///< renders, the spindle turns
  kPaused = 6,    ///< at rest under power until it is asked to go on
  kStop0 = 7,     ///< the arm is not under control: nothing that is commanded counts
  kStop1 = 8,     ///< brakes to rest; the request for motion is withdrawn
  kStop2 = 9,     ///< brakes to rest, stays under power and supervised
  kFault = 10,    ///< at rest, with a fault latched
  kRecovery = 11  ///< a recovery was asked for: waits for the arm and for every condition
};
inline constexpr int kCellStates = 12;

/// What a state machine is told, the worst first: of several in a tick the first counts first.
enum class CellEvent : std::uint8_t {
  kArmLost,       ///< the arm can not be commanded: silent, closed, of another period or command mode
  kFault,         ///< a fault is latched, and the arm takes commands
  kArmLeft,       ///< a message says that the arm is not in COMMANDING_ACTIVE
  kStopAsked,     ///< an orderly end
  kPauseAsked,    ///< an operator's pause
  kRestFault,     ///< at rest, with a fault latched
  kRest,          ///< at rest, without one
  kArmIdle,       ///< the arm does not say where it is
  kArmSeen,       ///< it does
  kNotInOrder,    ///< a condition of motion is missing, beside the handing over
  kInOrder,       ///< none is
  kBeginAway,     ///< every condition of motion holds; rendering begins elsewhere
  kBeginThere,    ///< every condition of motion holds; rendering begins here
  kSpindleTurns,  ///< the spindle turns
  kSpindleStill,  ///< it does not
  kRecover,       ///< a recovery was asked for, and each latched fault allows one
  kResume,        ///< the operator ends the pause
};
inline constexpr int kCellEvents = 17;

/// What is done on a transition. What a state does from tick to tick is its own (Describe).
enum class CellAction : std::uint8_t {
  kGoOn,            ///< nothing beside what the state does
  kFollowArm,       ///< commands what the arm commands itself
  kHold,            ///< what is commanded stands
  kBrake,           ///< brakes what is commanded to rest
  kBeginPath,       ///< to where rendering begins, from the joints that are commanded
  kBeginRendering,  ///< from the joints that are commanded, at rest, the coupling faded out
  kClearFaults,     ///< the latched faults are cleared
};

struct CellTransition {
  CellState state{CellState::kOff};
  CellAction action{CellAction::kGoOn};
  friend constexpr bool operator==(const CellTransition&, const CellTransition&) = default;
};

/// By state and event.
using CellTable = std::array<std::array<CellTransition, kCellEvents>, kCellStates>;
extern const CellTable kCellTable;

/// What follows.
[[nodiscard]] CellTransition Next(CellState state, CellEvent event) OSTEON_RT;

/// The arm is moved, or may be in the next tick: aligning, haptic, cutting.
[[nodiscard]] constexpr bool IsMotion(CellState state) noexcept {
  return state == CellState::kAligning || state == CellState::kHaptic || state == CellState::kCutting;
}
/// The coupling is rendered: haptic, cutting.
[[nodiscard]] constexpr bool Renders(CellState state) noexcept {
  return state == CellState::kHaptic || state == CellState::kCutting;
}
/// What is commanded is being braked: stop 1, stop 2.
[[nodiscard]] constexpr bool Brakes(CellState state) noexcept {
  return state == CellState::kStop1 || state == CellState::kStop2;
}
/// A stop under way, of any category.
[[nodiscard]] constexpr bool IsStop(CellState state) noexcept {
  return state == CellState::kStop0 || Brakes(state);
}
/// The arm is waited for, and followed as long as it moves by itself.
[[nodiscard]] constexpr bool Waits(CellState state) noexcept {
  return state == CellState::kOff || state == CellState::kChecking || state == CellState::kReady ||
         state == CellState::kRecovery;
}

struct CellStateText {
  const char* name;   ///< "stop 1"
  const char* does;   ///< from tick to tick
  const char* leave;  ///< how a user gets on from there
};
/// Texts for screens, reports and the documentation; not for the tick.
[[nodiscard]] CellStateText Describe(CellState state);
struct CellEventText {
  const char* name;     ///< "arm left"
  const char* meaning;  ///< when it is formed
};
[[nodiscard]] CellEventText Describe(CellEvent event);
[[nodiscard]] const char* NameOf(CellAction action);

}  // namespace osteon::safety
