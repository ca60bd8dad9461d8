#pragma once

#include <filesystem>

#include "config/reading/cell_config.h"

namespace osteon::config {

/// Applies the results of `osteon calibrate` to a cell: the payload and bias of the force sensor, and the
/// position of the tool's apex. Only the loop uses them; the simulated arm and sensor keep the values of
/// their files.
///
///     [payload: {mass_kg, center_mm (in the flange's frame), bias_N, bias_Nm}]
///     [tcp_mm: [x, y, z]]                   the apex in the flange's frame
///
/// @throws ConfigError naming file, line, what was found and what is accepted: values far from those of the
///   files of sensor and tool, which mean that another tool was mounted. Accepted differences: of the mass
///   the larger of 0.5 kg and half the mass, of the centre of mass 50 mm, of the apex 20 mm.
void ApplyCalibration(const std::filesystem::path& file, CellConfig& cell);

}  // namespace osteon::config
