#pragma once

#include <string>
#include <vector>

#include "config/reading/cell_config.h"
#include "simulation/bone/material.h"

namespace osteon::session {

/// One line for each figure of a run that has no source: of its tissues, and of what gives way. A figure of a
/// part that is off does not count.
/// @param materials  of the run's bone
[[nodiscard]] std::vector<std::string> AssumedFigures(const config::CellConfig& cell,
                                                      std::vector<simulation::Material> materials);

/// The same of a simulated cell's own devices: the arm's lag and the force sensor's delay, each until a file
/// of `osteon identify` has it.
[[nodiscard]] std::vector<std::string> AssumedOfSimulation(const config::CellConfig& cell);

}  // namespace osteon::session
