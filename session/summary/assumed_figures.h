#pragma once

#include <string>
#include <vector>

#include "config/reading/cell_config.h"
#include "simulation/bone/material.h"

namespace osteon::session {

/// Lists, one per line, the figures of a run that are assumed because they have no source: those of its
/// tissues, and those of tool, surface layer and mount if they give way. A part that the cell has switched
/// off is left out.
/// @param materials  the tissues of the run's bone
[[nodiscard]] std::vector<std::string> AssumedFigures(const config::CellConfig& cell,
                                                      std::vector<simulation::Material> materials);

/// Lists the same for a simulated cell's own devices: the arm's lag and the force sensor's delay, each unless
/// a file of `osteon identify` has measured it.
[[nodiscard]] std::vector<std::string> AssumedOfSimulation(const config::CellConfig& cell);

}  // namespace osteon::session
