#include "session/procedure/load_step.h"

#include "safety/cell_state.h"

namespace osteon::session {

double LoadStepError_N(const Vector3& f_before_S, const Vector3& f_after_S,
                       const control::ForceSensorParams& before, const control::ForceSensorParams& after,
                       const Pose& X_WF) {
  const Vector3 expected_S = control::ToolWeight(after, X_WF).f - control::ToolWeight(before, X_WF).f;
  return (f_after_S - f_before_S - expected_S).norm();
}

void PausedReadings::Add(const control::TickRecord& tick) {
  if (tick.cell_state != static_cast<std::uint8_t>(safety::CellState::kPaused)) {
    Restart();
    return;
  }
  const Vector3 f_S = tick.input.F_sensor_S.f;
  if (first_count_ < kTicks) {
    if (first_count_ == 0) first_sum_ = Vector3::Zero();
    first_sum_ += f_S;
    ++first_count_;
    return;
  }
  sum_ += f_S;
  if (++count_ < kTicks) return;
  newest_ = sum_ / kTicks;
  newest_count_ += kTicks;
  sum_ = Vector3::Zero();
  count_ = 0;
}

}  // namespace osteon::session
