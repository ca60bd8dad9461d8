#pragma once

#include "config/reading/cell_config.h"
#include "session/stops/trip_charts.h"

namespace osteon::session {

/// Collects the limits that a cell's stop pages show.
/// @param virtual_time  whether the run is in virtual time, where a message counts as missed after one
/// period;
///   in wall time after kArmDeadlinePeriods periods
[[nodiscard]] TripLimits TripLimitsOf(const config::CellConfig& cell, bool virtual_time);

}  // namespace osteon::session
