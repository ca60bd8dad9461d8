#pragma once

#include "app/report/trip_charts.h"
#include "config/cell_config.h"

namespace osteon::app {

/// What a cell's stops are held against. @param virtual_time  an arm message is missed after one period
[[nodiscard]] TripLimits TripLimitsOf(const config::CellConfig& cell, bool virtual_time);

}  // namespace osteon::app
