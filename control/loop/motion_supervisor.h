#pragma once

#include "base/marker.h"
#include "control/tick_record.h"
#include "safety/cell_state.h"
#include "safety/fault.h"
#include "safety/motion_permit.h"

namespace osteon::control {

/// Leads the cell's state by safety::kCellTable: the one place where an event is applied. Holds the latched
/// faults, the conditions of motion, and what was asked for.
///
/// Each tick derives events from its inputs, the most severe first, and applies them; whatever begins or ends
/// a motion is the caller's to do, by the action that Apply returns.
class MotionSupervisor {
 public:
  /// @returns what is to be done. Clears the faults where that is kClearFaults.
  [[nodiscard]] safety::CellAction Apply(safety::CellEvent event) OSTEON_RT;

  void Latch(safety::Fault fault) OSTEON_RT { faults_.Latch(fault); }
  void Latch(safety::FaultSet faults) OSTEON_RT { faults_.Latch(faults); }

  void SetPermits(safety::MotionPermits permits) OSTEON_RT { permits_ = permits; }
  /// The command follows the way to the start.
  void SetOnPath(bool on_path) OSTEON_RT { on_path_ = on_path; }
  /// Rendering begins: from now on there is no way to the start.
  void SetRendered() OSTEON_RT { rendered_ = true; }

  /// An orderly stop was asked for: as this tick sees it.
  void SetStopRequested(bool asked) OSTEON_RT { stop_requested_ = asked; }
  /// A pause was asked for. It counts until TakePauseRequest, while motion is under way or waited for.
  void RequestPause(bool asked) OSTEON_RT;
  /// @returns whether a pause is to begin now, and forgets it
  [[nodiscard]] bool TakePauseRequest() OSTEON_RT;

  [[nodiscard]] safety::CellState state() const OSTEON_RT { return state_; }
  [[nodiscard]] safety::FaultSet faults() const OSTEON_RT { return faults_; }
  [[nodiscard]] safety::MotionPermits permits() const OSTEON_RT { return permits_; }
  [[nodiscard]] bool stop_requested() const OSTEON_RT { return stop_requested_; }
  [[nodiscard]] bool on_path() const OSTEON_RT { return on_path_; }
  [[nodiscard]] bool rendered() const OSTEON_RT { return rendered_; }
  /// The arm was moved at least once: a fault of the drive then waits for a recovery.
  [[nodiscard]] bool moved() const OSTEON_RT { return moved_; }

  /// The state's name in the recording.
  [[nodiscard]] Phase phase() const OSTEON_RT;
  /// The arm is waited for, and its position is followed.
  [[nodiscard]] bool IsWaiting() const OSTEON_RT {
    return safety::Waits(state_) && phase() != Phase::kStopped;
  }
  /// Nothing is moved or braked, and no fault is latched.
  [[nodiscard]] bool IsWaitingOrPaused() const OSTEON_RT {
    return safety::Waits(state_) || state_ == safety::CellState::kPaused;
  }
  /// The arm is moved, or what is commanded is being braked.
  [[nodiscard]] bool MovesOrBrakes() const OSTEON_RT {
    return safety::IsMotion(state_) || safety::Brakes(state_);
  }
  /// A recovery would have an effect now.
  [[nodiscard]] bool CanRecover() const OSTEON_RT;

 private:
  safety::CellState state_{safety::CellState::kOff};
  safety::FaultSet faults_;
  safety::MotionPermits permits_;
  bool stop_requested_{false}, pause_requested_{false};
  bool on_path_{false}, rendered_{false}, moved_{false};
};

}  // namespace osteon::control
