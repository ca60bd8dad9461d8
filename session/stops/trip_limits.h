#pragma once

#include "config/reading/cell_config.h"
#include "session/stops/trip_charts.h"

namespace osteon::session {

/// Collects the limits that a cell's stop pages show.
/// @param virtual_time  true: the arm's message counts as missed after one period; false: after
/// kArmDeadlinePeriods periods
[[nodiscard]] TripLimits TripLimitsOf(const config::CellConfig& cell, bool virtual_time);

}  // namespace osteon::session
