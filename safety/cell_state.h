#pragma once

#include <array>
#include <cstdint>

#include "base/marker.h"

// The cell's state machine as data: one table of state × event → state, action. The servo loop runs on it,
// and docs/states.md is written from it.

namespace osteon::safety {

/// State of the cell. The numbers are recorded.
enum class CellState : std::uint8_t {
  kOff = 0,       ///< no arm reports its position, or the run was ended in order
  kChecking = 1,  ///< the arm moves by itself; not every condition of motion holds (motion_permit.h)
  kReady = 2,     ///< every condition holds except that the arm is handed over
  kAligning = 3,  ///< moves to the start of rendering
  kHaptic = 4,    ///< renders, the spindle still
  kCutting = 5,   ///< renders, the spindle turns
  kPaused = 6,    ///< at rest under power until the operator resumes
  kStop0 = 7,     ///< the arm is not under control: no command has an effect
  kStop1 = 8,     ///< brakes to rest; the request for motion is withdrawn
  kStop2 = 9,     ///< brakes to rest, stays under power and supervised
  kFault = 10,    ///< at rest, with a fault latched
  kRecovery = 11  ///< a recovery was requested: waits for the arm and for every condition
};
inline constexpr int kCellStates = 12;

/// Events of the state machine, most severe first: if several occur in a tick, they are applied in this
/// order.
enum class CellEvent : std::uint8_t {
  kArmLost,         ///< the arm cannot be commanded: silent, closed, of another period or command mode
  kFault,           ///< a fault is latched, and the arm takes commands
  kArmLeft,         ///< a message says that the arm is not in COMMANDING_ACTIVE
  kStopRequested,   ///< an orderly end was requested
  kPauseRequested,  ///< the operator requested a pause
  kRestFault,       ///< at rest, with a fault latched
  kRest,            ///< at rest, without one
  kArmIdle,         ///< the arm does not report its position
  kArmSeen,         ///< the arm reports its position
  kPermitsMissing,  ///< a condition of motion is missing, other than the handing over
  kPermitsHold,     ///< no condition is missing, other than the handing over
  kBeginAligning,   ///< every condition of motion holds; rendering begins elsewhere
  kBeginRendering,  ///< every condition of motion holds; rendering begins here
  kSpindleTurns,    ///< the spindle turns
  kSpindleStill,    ///< the spindle stands
  kRecover,         ///< a recovery was requested, and each latched fault allows one
  kResume,          ///< the operator ends the pause
};
inline constexpr int kCellEvents = 17;

/// Action of a transition. For the behaviour of a state from tick to tick, see Describe(CellState).
enum class CellAction : std::uint8_t {
  kNone,            ///< nothing beyond what the state does
  kFollowArm,       ///< commands the arm's own position
  kHold,            ///< keeps the command constant
  kBrake,           ///< brakes the commanded motion to rest
  kBeginPath,       ///< starts the path to the start of rendering, from the commanded joints
  kBeginRendering,  ///< starts to render from the commanded joints, at rest, the coupling faded out
  kClearFaults,     ///< clears the latched faults
};

struct CellTransition {
  CellState state{CellState::kOff};
  CellAction action{CellAction::kNone};
  friend constexpr bool operator==(const CellTransition&, const CellTransition&) = default;
};

/// Transitions by state and event.
using CellTable = std::array<std::array<CellTransition, kCellEvents>, kCellStates>;
extern const CellTable kCellTable;

/// The transition for an event in a state.
[[nodiscard]] CellTransition Next(CellState state, CellEvent event) OSTEON_RT;

/// Whether the arm moves, or may move in the next tick: aligning, haptic, cutting.
[[nodiscard]] constexpr bool IsMotion(CellState state) noexcept {
  return state == CellState::kAligning || state == CellState::kHaptic || state == CellState::kCutting;
}
/// Whether the coupling is rendered: haptic, cutting.
[[nodiscard]] constexpr bool Renders(CellState state) noexcept {
  return state == CellState::kHaptic || state == CellState::kCutting;
}
/// Whether the commanded motion is being braked: stop 1, stop 2.
[[nodiscard]] constexpr bool Brakes(CellState state) noexcept {
  return state == CellState::kStop1 || state == CellState::kStop2;
}
/// Whether a stop of any category is under way.
[[nodiscard]] constexpr bool IsStop(CellState state) noexcept {
  return state == CellState::kStop0 || Brakes(state);
}
/// Whether the loop waits for the arm, and follows it as long as it moves by itself.
[[nodiscard]] constexpr bool Waits(CellState state) noexcept {
  return state == CellState::kOff || state == CellState::kChecking || state == CellState::kReady ||
         state == CellState::kRecovery;
}

struct CellStateText {
  const char* name;   ///< "stop 1"
  const char* does;   ///< behaviour from tick to tick
  const char* leave;  ///< how the user leaves this state
};
/// Texts for screens, reports and the documentation; not for the tick.
[[nodiscard]] CellStateText Describe(CellState state);
struct CellEventText {
  const char* name;     ///< "arm left"
  const char* meaning;  ///< when the event occurs
};
[[nodiscard]] CellEventText Describe(CellEvent event);
[[nodiscard]] const char* NameOf(CellAction action);

}  // namespace osteon::safety
