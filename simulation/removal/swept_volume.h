#pragma once

#include "simulation/solids/solid.h"
#include "simulation/tools/swept_tool.h"

namespace osteon::simulation {

/// Volume [m³] of the part of the solid that tools swept, measured as by SweptVolume in cut_metrics.h.
/// @param cell_m  edge of a cell of the grid
/// @param threads  0: one per core. The volume does not depend on their number
[[nodiscard]] double SweptVolume(const Solid& solid, const SweptTool& swept, double cell_m, int threads = 0);

}  // namespace osteon::simulation
