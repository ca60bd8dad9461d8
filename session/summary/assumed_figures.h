#pragma once

#include <string>
#include <vector>

#include "config/reading/cell_config.h"
#include "simulation/bone/material.h"

namespace osteon::session {

/// Lists, one per line, the figures of a run that are assumed because they have no source: those of its
/// tissues, and those of tool, surface layer and mount if the cell models their compliance. A part that the
/// cell has switched off is left out.
/// @param materials  the tissues of the run's bone
[[nodiscard]] std::vector<std::string> AssumedFigures(const config::CellConfig& cell,
                                                      std::vector<simulation::Material> materials);

/// Lists the assumed figures of a simulated cell's devices: the arm's lag and the force sensor's delay. A
/// figure that a file of `osteon identify` gives is left out.
[[nodiscard]] std::vector<std::string> AssumedOfSimulation(const config::CellConfig& cell);

}  // namespace osteon::session
