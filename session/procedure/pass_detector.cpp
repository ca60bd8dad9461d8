#include "session/procedure/pass_detector.h"

#include <algorithm>

namespace osteon::session {

bool CutDetector::Step(const simulation::ContactModel& model, double spindle_rad_per_s) {
  if (known_) before_m3_ = removed_m3_;
  if (model.status != simulation::EngineStatus::kOk) return false;
  if (!known_) before_m3_ = model.removed_volume_m3;
  removed_m3_ = model.removed_volume_m3;
  known_ = true;
  return spindle_rad_per_s > 0.0 && (removed_m3_ > before_m3_ || model.advance_m_per_s > 0.0);
}

PassDetector::Change PassDetector::Step(const simulation::ContactModel& model, rt::Nanoseconds stamp,
                                        double spindle_rad_per_s) {
  if (model.status != simulation::EngineStatus::kOk) return Change::kNone;
  const double dt_s = last_ == 0 ? 0.0 : std::clamp(rt::ToSeconds(stamp - last_), 0.0, kMaxFrameGap_s);
  const bool cuts = cut_.Step(model, spindle_rad_per_s);
  last_ = stamp;
  clear_ = model.contact_count == 0;
  if (cuts) {
    const bool begins = !open_;
    if (begins) {
      open_ = true;
      begin_ = stamp;
      cutting_s_ = 0.0;
      removed_at_begin_m3_ = cut_.removed_before_m3();
    }
    cutting_s_ += dt_s;
    clear_since_ = 0;
    return begins ? Change::kBegan : Change::kNone;
  }
  if (!open_ || !clear_) {
    clear_since_ = 0;
    return Change::kNone;
  }
  if (clear_since_ == 0) clear_since_ = stamp;
  if (stamp - clear_since_ < kClearOfPass) return Change::kNone;
  open_ = false;
  clear_since_ = 0;
  return Change::kEnded;
}

void PassDetector::Restart() {
  open_ = false;
  cut_.Restart();
  clear_since_ = last_ = 0;
}

}  // namespace osteon::session
