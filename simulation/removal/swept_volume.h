#pragma once

#include "simulation/solids/solid.h"
#include "simulation/tools/swept_tool.h"

namespace osteon::simulation {

/// Volume of the solid that lies within what tools swept [m³], as SweptVolume of cut_metrics.h counts it.
/// @param cell_m  edge of a cell of the grid
/// @param threads  0: one per core. The volume does not depend on their number
[[nodiscard]] double SweptVolume(const Solid& solid, const SweptTool& swept, double cell_m, int threads = 0);

}  // namespace osteon::simulation
