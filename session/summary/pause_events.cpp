#include "session/summary/pause_events.h"

#include "control/loop/tick_state.h"

namespace osteon::session {

void PauseEvents::Add(const control::TickRecord& tick) {
  if (!start_) start_ = tick.stamp;
  const bool paused = control::IsPaused(tick);
  const auto add_row = [&](const char* name, rt::Nanoseconds at, rt::Nanoseconds lasted) {
    rows_.push_back(
        {.name = name, .time_s = rt::ToSeconds(at - *start_), .value = rt::ToSeconds(lasted), .unit = "s"});
  };
  if (tick.input.pause && !paused_at_) asked_at_ = asked_at_.value_or(tick.stamp);
  if (paused && !paused_at_) {
    paused_at_ = tick.stamp;
    const rt::Nanoseconds asked_at = asked_at_.value_or(tick.stamp);
    add_row(kPauseEvent, asked_at, tick.stamp - asked_at);
    asked_at_.reset();
  }
  if (!paused && paused_at_) {  // a pause that lasts until the run's end has no resume event
    if (tick.input.resume) add_row(kResumeEvent, tick.stamp, tick.stamp - *paused_at_);
    paused_at_.reset();
  }
}

}  // namespace osteon::session
