#pragma once

#include <filesystem>

#include "config/reading/cell_config.h"

namespace osteon::config {

/// Overrides a cell by the results of `osteon calibrate`: how the loop reads the force sensor, and where the
/// tool's apex is. The simulated cell keeps its files' values.
///
///     [payload: {mass_kg, center_mm (in the flange's frame), bias_N, bias_Nm}]
///     [tcp_mm: [x, y, z]]                   the apex in the flange's frame
///
/// @throws ConfigError naming file, line, what was found and what is accepted: a mass, a centre or an apex
///   far from the files of sensor and tool (the larger of 0.5 kg and half the mass; 50 mm; 20 mm) means
///   another tool.
void ApplyCalibration(const std::filesystem::path& file, CellConfig& cell);

}  // namespace osteon::config
