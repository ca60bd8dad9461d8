#include "session/run/live_latency.h"

#include <cmath>

namespace osteon::session {
namespace {

constexpr double kPublishInterval_s = 0.25;  // time between two updates of the figures

}  // namespace

LiveLatency::LiveLatency(const config::CellConfig& cell, io::RecordSink& next)
    : next_(next), context_(LatencyContextOf(cell, false)), period_s_(cell.servo.period_s) {}

void LiveLatency::TakeTick(const control::TickRecord& tick) {
  meter_.Add(tick);
  if (++ticks_ >= std::lround(kPublishInterval_s / period_s_))
    if (const std::unique_lock lock(mutex_, std::try_to_lock);
        lock) {  // if a reader holds the lock, the next tick tries again
      figures_ = meter_.Figures(period_s_, context_);
      ticks_ = 0;
    }
  next_.TakeTick(tick);
}

console::LatencyStatus LiveLatency::Status() const {
  LatencyFigures figures;
  {
    const std::lock_guard lock(mutex_);
    figures = figures_;
  }
  console::LatencyStatus status{.known = !figures.parts.empty(),
                                .measured = figures.Measured(),
                                .hand_moves_arm = figures.hand_moves_arm,
                                .hand_to_arm_ms = 1e3 * figures.hand_to_arm_s,
                                .bone_to_hand_ms = 1e3 * figures.bone_to_hand_s};
  for (const LatencyPart& part : figures.parts)
    status.parts.push_back({.name = part.name, .mean_ms = 1e3 * part.mean_s, .measured = part.measured});
  return status;
}

}  // namespace osteon::session
