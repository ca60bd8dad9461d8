#pragma once

#include <vector>

#include "base/clock.h"
#include "base/marker.h"
#include "hil/injection/wire_faults.h"

namespace osteon::hil {

/// The faults of one wire in one direction, by time. No allocation after construction.
class FaultSchedule {
 public:
  /// @param direction  kBoth: faults of either direction
  /// @throws std::invalid_argument from Validate.
  FaultSchedule(const InjectionParams& params, Wire wire, Direction direction);

  /// Starts the schedule's time at `now`, when COMMANDING_ACTIVE is seen. Later calls change nothing.
  void StartSchedule(rt::Nanoseconds now) OSTEON_RT {
    if (!begun_) begun_at_ = now;
    begun_ = true;
  }

  /// The sum of all faults that act at `now`.
  [[nodiscard]] WireFaults At(rt::Nanoseconds now) const OSTEON_RT;

  /// Whether no fault is scheduled.
  [[nodiscard]] bool empty() const { return windows_.empty(); }

 private:
  struct Window {
    rt::Nanoseconds from, to;  ///< from the schedule's start
    WireFaults faults;
  };
  std::vector<Window> windows_;
  bool begun_{false};
  rt::Nanoseconds begun_at_{0};
};

}  // namespace osteon::hil
