#pragma once

#include <optional>

#include "config/reading/cell_config.h"

namespace osteon::config {

/// Translational mobility of an LBR at the tool's apex in the cell's start posture [1/kg], in the base's
/// frame B: a force f there accelerates the apex by mobility * f. Nothing for an arm without masses.
[[nodiscard]] std::optional<Matrix3> ToolMobility(const CellConfig& cell);

}  // namespace osteon::config
