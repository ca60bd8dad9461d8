#pragma once

#include "app/report/trip_charts.h"
#include "config/cell_config.h"

namespace osteon::app {

/// Collects the limits that a cell's stop pages show. @param virtual_time  a message is missed after one
/// period
[[nodiscard]] TripLimits TripLimitsOf(const config::CellConfig& cell, bool virtual_time);

}  // namespace osteon::app
