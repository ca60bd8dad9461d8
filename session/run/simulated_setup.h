#pragma once

#include "config/reading/cell_config.h"
#include "hil/cell_host.h"
#include "hil/simulated_cell.h"

namespace osteon::session {

/// Makes a cell's simulated arm and operator.
/// @param seconds  duration of the operator's script; 0: as the cell's file says
[[nodiscard]] hil::SimulatedCell MakeSimulatedCell(const config::CellConfig& cell, double seconds);

/// Makes the parameters of the process that simulates a cell in wall time, on the connections that the
/// configuration names.
[[nodiscard]] hil::CellHostParams HostParams(const config::CellConfig& cell);

}  // namespace osteon::session
