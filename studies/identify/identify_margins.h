#pragma once

#include "config/reading/cell_config.h"
#include "studies/identify/identify_result.h"

namespace osteon::studies {

/// The highest frequency at which the loop of the cell's law, its present gains and this axis has a gain of 1
/// in free air, over all hands up to the grip for which the tool has to stay light [Hz]. The response must be
/// known up to this frequency. None under the impedance law, and if no hand reaches a gain of 1.
[[nodiscard]] std::optional<double> CrossingOf(const config::CellConfig& cell, const AxisResult& axis);

/// Judges the cell's present gains by the response that was measured, as `osteon tune --identified` does: for
/// each hand, in free air, at a wall and on planes. Fills the result's margins and its Nyquist plot. It does
/// nothing under the impedance law, without a free run, or if something was refused.
void JudgeGains(const config::CellConfig& cell, IdentifyResult& result);

}  // namespace osteon::studies
