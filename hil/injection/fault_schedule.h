#pragma once

#include <vector>

#include "base/clock.h"
#include "base/marker.h"
#include "hil/injection/wire_faults.h"

namespace osteon::hil {

/// The scheduled faults of one wire in one direction. No allocation after construction.
class FaultSchedule {
 public:
  /// @param direction  direction whose faults are scheduled; kBoth: the faults of both directions
  /// @throws std::invalid_argument from Validate.
  FaultSchedule(const InjectionParams& params, Wire wire, Direction direction);

  /// Sets the schedule's time 0 to `now`; call when COMMANDING_ACTIVE is first observed. Later calls change
  /// nothing.
  void StartSchedule(rt::Nanoseconds now) OSTEON_RT {
    if (!begun_) begun_at_ = now;
    begun_ = true;
  }

  /// The sum of all faults that are active at `now`.
  [[nodiscard]] WireFaults At(rt::Nanoseconds now) const OSTEON_RT;

  /// Whether no fault is scheduled.
  [[nodiscard]] bool empty() const { return windows_.empty(); }

 private:
  struct Window {
    rt::Nanoseconds from, to;  ///< relative to the schedule's start
    WireFaults faults;
  };
  std::vector<Window> windows_;
  bool begun_{false};
  rt::Nanoseconds begun_at_{0};
};

}  // namespace osteon::hil
