#pragma once

#include "base/marker.h"
#include "control/tick_record.h"
#include "safety/cell_state.h"
#include "safety/fault.h"
#include "safety/motion_permit.h"

namespace osteon::control {

/// The cell's state machine. It alone changes the state, according to safety::kCellTable. It also stores the
/// latched faults, the conditions of motion, and the pending requests.
///
/// Each tick derives events from its inputs, most severe first, and applies them. Apply returns the action of
/// the transition. The caller carries the action out, which may begin or end a motion.
class MotionSupervisor {
 public:
  /// Applies an event to the state. If the transition's action is kClearFaults, clears the latched faults.
  /// @returns the action, for the caller to carry out
  [[nodiscard]] safety::CellAction Apply(safety::CellEvent event) OSTEON_RT;

  void Latch(safety::Fault fault) OSTEON_RT { faults_.Latch(fault); }
  void Latch(safety::FaultSet faults) OSTEON_RT { faults_.Latch(faults); }

  void SetPermits(safety::MotionPermits permits) OSTEON_RT { permits_ = permits; }
  /// Sets whether the commanded motion is the path to the start.
  void SetOnPath(bool on_path) OSTEON_RT { on_path_ = on_path; }
  /// Call when rendering begins. After that, the loop does not move the arm to the start again.
  void SetRendered() OSTEON_RT { rendered_ = true; }

  /// Sets whether an orderly stop is requested in this tick.
  void SetStopRequested(bool asked) OSTEON_RT { stop_requested_ = asked; }
  /// If `asked`, stores a pause request until TakePauseRequest. In a state that neither moves nor waits for
  /// motion, drops the request.
  void RequestPause(bool asked) OSTEON_RT;
  /// Returns whether a pause request is stored, and clears it.
  [[nodiscard]] bool TakePauseRequest() OSTEON_RT;

  [[nodiscard]] safety::CellState state() const OSTEON_RT { return state_; }
  [[nodiscard]] safety::FaultSet faults() const OSTEON_RT { return faults_; }
  [[nodiscard]] safety::MotionPermits permits() const OSTEON_RT { return permits_; }
  [[nodiscard]] bool stop_requested() const OSTEON_RT { return stop_requested_; }
  [[nodiscard]] bool on_path() const OSTEON_RT { return on_path_; }
  [[nodiscard]] bool rendered() const OSTEON_RT { return rendered_; }
  /// Whether the loop has ever moved the arm. Before that, faults of the drive are cleared automatically;
  /// afterwards only in a recovery.
  [[nodiscard]] bool moved() const OSTEON_RT { return moved_; }

  /// Phase of the run in the recording; follows from the state.
  [[nodiscard]] Phase phase() const OSTEON_RT;
  /// Whether the loop waits for the arm and follows its position.
  [[nodiscard]] bool IsWaiting() const OSTEON_RT {
    return safety::Waits(state_) && phase() != Phase::kStopped;
  }
  /// Whether the loop neither moves nor brakes the arm, because it waits for motion or is paused.
  [[nodiscard]] bool IsWaitingOrPaused() const OSTEON_RT {
    return safety::Waits(state_) || state_ == safety::CellState::kPaused;
  }
  /// Whether the arm is moved, or its commanded motion is being braked.
  [[nodiscard]] bool MovesOrBrakes() const OSTEON_RT {
    return safety::IsMotion(state_) || safety::Brakes(state_);
  }
  /// Whether a recovery request would have an effect now.
  [[nodiscard]] bool CanRecover() const OSTEON_RT;

 private:
  safety::CellState state_{safety::CellState::kOff};
  safety::FaultSet faults_;
  safety::MotionPermits permits_;
  bool stop_requested_{false}, pause_requested_{false};
  bool on_path_{false};                  // the commanded motion is the path to the start
  bool rendered_{false}, moved_{false};  // has ever rendered; has ever moved the arm
};

}  // namespace osteon::control
