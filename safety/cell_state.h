#pragma once

#include <array>
#include <cstdint>

#include "base/marker.h"

// The cell's state machine as data: one table of state × event → state, action. The servo loop uses the
// table, and docs/states.md is generated from it.

namespace osteon::safety {

/// State of the cell. The numbers are recorded.
enum class CellState : std::uint8_t {
  kOff = 0,  ///< no arm reports its position, or the run was ended in an orderly way
  /// the arm is controlled by its own program; not every condition of motion holds (motion_permit.h)
  kChecking = 1,
  kReady = 2,  ///< every condition of motion holds, except that the arm has not been handed over to the loop
  kAligning = 3,  ///< the arm moves to the posture in which rendering starts
  kHaptic = 4,    ///< the coupling is rendered, the spindle stands still
  kCutting = 5,   ///< the coupling is rendered, the spindle turns
  kPaused = 6,    ///< at rest under power until the operator resumes
  kStop0 = 7,     ///< the arm is not under control: no command has an effect
  kStop1 = 8,     ///< brakes to rest; the request for motion is withdrawn
  kStop2 = 9,     ///< brakes to rest, stays under power and supervised
  kFault = 10,    ///< at rest, with a fault latched
  kRecovery = 11  ///< a recovery was requested; the cell waits for the arm and for every condition of motion
};
inline constexpr int kCellStates = 12;

/// Events of the state machine, most severe first: if several occur in a tick, they are applied in this
/// order.
enum class CellEvent : std::uint8_t {
  kArmLost,         ///< the arm cannot be commanded: it is silent, its connection is closed, or its period or
                    ///< command mode is wrong
  kFault,           ///< a fault is latched, and the arm takes commands
  kArmLeft,         ///< a message says that the arm is not in COMMANDING_ACTIVE
  kStopRequested,   ///< an orderly end was requested
  kPauseRequested,  ///< the operator requested a pause
  kRestFault,       ///< at rest, with a fault latched
  kRest,            ///< at rest, with no fault latched
  kArmIdle,         ///< the arm does not report its position
  kArmSeen,         ///< the arm reports its position
  kPermitsMissing,  ///< a condition of motion is missing, apart from the hand-over of the arm
  kPermitsHold,     ///< every condition of motion holds, apart from the hand-over of the arm
  kBeginAligning,   ///< every condition of motion holds; the arm is not yet in the posture in which rendering
                    ///< starts
  kBeginRendering,  ///< every condition of motion holds; the arm is in the posture in which rendering starts
  kSpindleTurns,    ///< the spindle turns
  kSpindleStill,    ///< the spindle stands
  kRecover,         ///< a recovery was requested, and each latched fault allows one
  kResume,          ///< the operator ends the pause
};
inline constexpr int kCellEvents = 17;

/// Action of a transition. For the behaviour of a state from tick to tick, see Describe(CellState).
enum class CellAction : std::uint8_t {
  kNone,            ///< no action besides the state's own behaviour
  kFollowArm,       ///< commands the arm's own position
  kHold,            ///< keeps the command constant
  kBrake,           ///< brakes the commanded motion to rest
  kBeginPath,       ///< starts the path from the commanded joint positions to the posture in which rendering
                    ///< starts
  kBeginRendering,  ///< starts to render at the commanded joint positions, at rest, with the coupling faded
                    ///< out
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
/// Whether the loop waits for the arm, and follows the arm's position while the arm's own program controls
/// it.
[[nodiscard]] constexpr bool Waits(CellState state) noexcept {
  return state == CellState::kOff || state == CellState::kChecking || state == CellState::kReady ||
         state == CellState::kRecovery;
}

struct CellStateText {
  const char* name;   ///< "stop 1"
  const char* does;   ///< behaviour from tick to tick
  const char* leave;  ///< how the user leaves this state
};
/// Returns texts for screens, reports and the documentation. Not to be called in the tick.
[[nodiscard]] CellStateText Describe(CellState state);
struct CellEventText {
  const char* name;     ///< "arm left"
  const char* meaning;  ///< when the event occurs
};
[[nodiscard]] CellEventText Describe(CellEvent event);
[[nodiscard]] const char* NameOf(CellAction action);

}  // namespace osteon::safety
