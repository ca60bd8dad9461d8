#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "config/reading/cell_config.h"
#include "config/reading/identified_cell.h"

namespace osteon::config {

/// Returns the measurement, among all axes and speeds, with the largest total lag: the slowest motion decides
/// the stability. Null if no arm was measured.
[[nodiscard]] const IdentifiedArm* SlowestArm(const IdentifiedCell& identified);

/// Reads a file of `osteon identify` for this cell (ReadIdentifiedFor), and keeps it as cell.identified.
///
/// The simulated arm gets the bandwidth, damping ratio and dead time of SlowestArm; the dynamic arm rounds
/// the dead time to whole periods. With the impedance law and a measured mass, only the dynamic arm changes:
/// it gets the longest measured dead time, rounded up to whole periods, and the measured springs and damping
/// (an older file has no springs: they follow from the mass if wrenches are overlaid). If the file has a
/// response or forces but no model of the arm, the simulated arm stays unchanged. The dead zone becomes at
/// least the measured one; `vibration` gets the measured tremor_N and notch_hz.
/// @throws ConfigError naming the file if it belongs to another cell, has no measurement, or has a value that
///   the simulated arm does not accept: a dead time outside 0 … 32 periods, or a damping ratio above 10.
void ApplyIdentified(const std::filesystem::path& file, CellConfig& cell);

/// Describes cell.identified, one line for each figure: the simulated arm, the sensor's delay, the dead zone,
/// the tremor, the notches' width and the number of hands. Empty if the cell has no identified figures.
[[nodiscard]] std::vector<std::string> IdentifiedText(const CellConfig& cell);

}  // namespace osteon::config
