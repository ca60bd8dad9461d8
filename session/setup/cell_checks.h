#pragma once

#include <vector>

#include "config/reading/cell_config.h"
#include "session/setup/doctor.h"

namespace osteon::session {

/// Examines whether this machine can reach what a cell's file names: the network card and the port at which
/// the arm's messages arrive (the guard's as well), the interface of each CAN bus, and the PLC, which has its
/// `connect_timeout_ms` to accept a connection. Sends nothing to arm, bus or PLC. An address that only a
/// simulated cell has gets the verdict *usable*, and the text says so.
void ExamineCell(std::vector<Check>& checks, const config::CellConfig& cell);

}  // namespace osteon::session
