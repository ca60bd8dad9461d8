#include "session/summary/drive_fault_rows.h"

#include "io/can/drive_fault_text.h"

namespace osteon::session {

void DriveFaultRows::Add(const control::TickRecord& tick) {
  if (!start_) start_ = tick.stamp;
  const control::TickInput& in = tick.input;
  const auto newly_latched = static_cast<std::uint8_t>(in.drive_faults & ~before_);
  const bool cleared = before_ != 0 && in.drive_faults == 0;
  before_ = in.drive_faults;
  if (newly_latched == 0 && !cleared) return;
  rows_.push_back({.time_s = rt::ToSeconds(tick.stamp - *start_),
                   .latched = newly_latched,
                   .nmt_state = in.drive_nmt_state,
                   .emergency_code = in.drive_emergency_code,
                   .error_code = in.drive_error_code,
                   .text = cleared
                               ? "reset"
                               : io::DescribeDriveFaults({newly_latched, in.drive_nmt_state,
                                                          in.drive_emergency_code, in.drive_error_code})});
}

}  // namespace osteon::session
