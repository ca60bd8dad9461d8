#pragma once

#include <span>
#include <string>
#include <vector>

#include "control/tick_record.h"

namespace osteon::report {

/// The time axis of a chart.
struct TimeAxis {
  rt::Nanoseconds zero{0};        ///< stamp at which the axis shows 0; earlier stamps have negative times
  std::string label{"time [s]"};  ///< below the axis
  std::string mark{};             ///< written along a vertical line at 0; empty: no line

  /// Time of a stamp [s].
  [[nodiscard]] double At(rt::Nanoseconds stamp) const { return rt::ToSeconds(stamp - zero); }
  /// Time of each tick [s].
  [[nodiscard]] std::vector<double> Of(std::span<const control::TickRecord> ticks) const {
    std::vector<double> times_s;
    times_s.reserve(ticks.size());
    for (const control::TickRecord& tick : ticks) times_s.push_back(At(tick.stamp));
    return times_s;
  }
};

}  // namespace osteon::report
