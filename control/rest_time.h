#pragma once

#include "control/rt/clock.h"
#include "control/rt/marker.h"
#include "safety/cell_state.h"

namespace osteon::control {

/// Tells how long a loop that has stopped still goes on, so that its recording shows the arm at rest.
///
/// Rest begins with the first stopped tick that is no longer in stop 0: an arm that is not under control is
/// only at rest once it is measured to stand. One that is never seen to stand (it is silent) is waited for
/// kMaxTimes as long in all.
class RestTime {
 public:
  static constexpr int kMaxTimes = 4;

  /// @param rest  to go on for after rest has begun, >= 0; 0: not at all
  explicit RestTime(rt::Nanoseconds rest) : rest_(rest) {}

  /// Once a tick of a loop whose phase is Phase::kStopped. @returns true where the run may end.
  [[nodiscard]] bool IsOver(safety::CellState state, rt::Nanoseconds now) OSTEON_RT {
    if (stopped_at_ < 0) stopped_at_ = now;
    if (rests_since_ < 0 && state != safety::CellState::kStop0) rests_since_ = now;
    return (rests_since_ >= 0 && now - rests_since_ >= rest_) || rest_ == 0 ||
           now - stopped_at_ >= kMaxTimes * rest_;
  }

 private:
  rt::Nanoseconds rest_, stopped_at_{-1}, rests_since_{-1};
};

}  // namespace osteon::control
