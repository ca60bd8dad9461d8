#pragma once

#include "config/cell_config.h"
#include "hil/cell_host.h"
#include "hil/simulated_cell.h"

namespace osteon::app {

/// Arm and operator of a cell. @param seconds  of the operator's script; 0: as long as its file says
[[nodiscard]] hil::SimulatedCell MakeSimulatedCell(const config::CellConfig& cell, double seconds);

/// What a process has to play of a cell in wall time, on the wires that the configuration names.
[[nodiscard]] hil::CellHostParams HostParams(const config::CellConfig& cell);

}  // namespace osteon::app
