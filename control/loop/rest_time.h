#pragma once

#include "base/clock.h"
#include "base/marker.h"
#include "safety/cell_state.h"

namespace osteon::control {

/// Tells how long a stopped loop still runs, so that its recording shows the arm at rest.
///
/// Rest begins with the first stopped tick that is no longer in stop 0: an arm that is not under control
/// counts as at rest only once it is measured to stand. If it is never measured to stand (a silent arm), the
/// loop ends after kMaxTimes the rest.
class RestTime {
 public:
  static constexpr int kMaxTimes = 4;

  /// @param rest  how long to run after rest has begun, >= 0; 0: not at all
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
