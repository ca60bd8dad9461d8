#include "session/replay/recarve.h"

#include <algorithm>

#include "safety/cell_state.h"

namespace osteon::session {

// Takes the same pose as ServoLoop::tool_command: the commanded pose at the tick's time or, if an arm in its
// own impedance control renders, the measured pose at the time of the arm's message.
void Recarve::Add(const control::TickRecord& tick) {
  const bool renders = safety::Renders(static_cast<safety::CellState>(tick.cell_state));
  const bool measured = measured_ && renders;
  places_[next_] = {.stamp = measured ? tick.input.arm_stamp : tick.input.now,
                    .X_WT = tick.compliance.present ? tick.compliance.X_ME
                            : measured              ? tick.X_WT_meas
                                                    : tick.X_WT_cmd,
                    .spindle_rad_per_s = tick.spindle_rad_per_s};
  newest_ = std::max(newest_, places_[next_].stamp);
  next_ = (next_ + 1) % kKept;
}

void Recarve::Add(const simulation::FrameRecord& frame) {
  const rt::Nanoseconds stamp = frame.model.pose_stamp;
  const auto place = std::ranges::find(places_, stamp, &Place::stamp);
  if (stamp == 0 || place == places_.end()) {
    ++left_out_;
    return;
  }
  const double dt_s = last_stamp_ == 0 ? 0.0 : rt::ToSeconds(stamp - last_stamp_);
  last_stamp_ = stamp;
  (void)engine_->Step({.X_WT = place->X_WT,
                       .spindle_rad_per_s = place->spindle_rad_per_s,
                       .dt_s = std::clamp(dt_s, 0.0, dt_limit_s_),
                       .stamp = stamp});
  ++frames_;
}

std::optional<simulation::FrameRecord> Recarve::NextDue(bool at_end) {
  if (waiting_.empty()) return std::nullopt;
  if (!at_end && waiting_.front().model.pose_stamp > newest_) return std::nullopt;
  const simulation::FrameRecord frame = waiting_.front();
  waiting_.pop_front();
  return frame;
}

}  // namespace osteon::session
