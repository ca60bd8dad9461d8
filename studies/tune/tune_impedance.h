#pragma once

#include "config/reading/cell_config.h"
#include "studies/tune/tune.h"

namespace osteon::studies {

/// Runs `osteon tune` for a cell with the impedance law; see RunTune.
[[nodiscard]] int RunTuneImpedance(const TuneOptions& options, const config::CellConfig& cell);

}  // namespace osteon::studies
