#pragma once

#include "base/clock.h"
#include "base/marker.h"
#include "safety/cell_state.h"

namespace osteon::control {

/// Decides when a stopped loop may end, so that its recording shows the arm at rest for a while.
///
/// Rest begins with the first stopped tick that is not in stop 0. In stop 0 the arm is not under control, and
/// the state lasts until the arm is measured to stand. If that never happens (a silent arm), the loop ends
/// after kMaxTimes the rest time.
class RestTime {
 public:
  static constexpr int kMaxTimes = 4;  ///< longest time after the first stopped tick, in rest times

  /// @param rest  rest time: how long the loop still runs after rest has begun, >= 0; 0: it ends at once
  explicit RestTime(rt::Nanoseconds rest) : rest_(rest) {}

  /// Call once per tick of a loop in Phase::kStopped. @returns true if the run may end.
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
