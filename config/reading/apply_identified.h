#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "config/reading/cell_config.h"
#include "config/reading/identified_cell.h"

namespace osteon::config {

/// The measurement of the arm that counts: of all axes and speeds the one with the greatest total lag, since
/// the slowest motion decides the stability. Null: none was measured.
[[nodiscard]] const IdentifiedArm* SlowestArm(const IdentifiedCell& identified);

/// Reads a file of `osteon identify` for this cell (ReadIdentifiedFor), keeps it as cell.identified, and
/// gives the simulated arm the bandwidth, damping ratio and dead time of SlowestArm. The dynamic arm rounds
/// the dead time to whole periods, upward with the impedance law, where an overlay of wrenches also has its
/// spring and damping. A dead zone becomes at least the measured one; `vibration` has its tremor_N and
/// notch_hz. Without an arm's model, but with a response or forces, the simulated arm stays as it is.
/// @throws ConfigError naming the file: another cell's, without any measurement, or beyond what the
/// simulated
///   arm can be: 0 … 32 periods of dead time, a damping ratio of at most 10
void ApplyIdentified(const std::filesystem::path& file, CellConfig& cell);

/// The figures that a cell has of its file, a line each: the arm's lag, its springs, the dead zone, the
/// tremor, the notch and the sensor's delay. Empty: nothing was identified.
[[nodiscard]] std::vector<std::string> IdentifiedText(const CellConfig& cell);

}  // namespace osteon::config
