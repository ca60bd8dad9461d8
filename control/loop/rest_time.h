#pragma once

#include "base/clock.h"
#include "base/marker.h"
#include "safety/cell_state.h"

namespace osteon::control {

/// Decides when a stopped loop may end. The loop continues for a while, so that its recording shows the arm
/// at rest.
///
/// Rest begins with the first tick in Phase::kStopped whose state is not stop 0. In stop 0 the arm is not
/// under control; this state lasts until the arm, by measurement, stands still. If that never happens,
/// because the arm sends no messages, the loop ends after kMaxTimes × the rest time.
class RestTime {
 public:
  /// longest time after the first stopped tick, as a multiple of the rest time
  static constexpr int kMaxTimes = 4;

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
