#pragma once

#include "config/reading/cell_config.h"
#include "studies/identify/identify_result.h"

namespace osteon::studies {

/// Returns the highest frequency [Hz] at which the loop has a gain of 1 in free air, for the cell's law and
/// present gains and the response of this axis. It is the highest over all hands up to the grip
/// (TuneTask::human_grip_N_per_m) up to which the tool has to stay light. The response must be known up to
/// this frequency. None with the impedance law, and if no hand reaches a gain of 1.
[[nodiscard]] std::optional<double> CrossingOf(const config::CellConfig& cell, const AxisResult& axis);

/// Judges the cell's present gains by the measured response, as `osteon tune --identified` does: for each
/// hand, in free air, at a wall and on planes. Fills in the result's margins and its Nyquist plot. Does
/// nothing with the impedance law, without a free run, or if something was refused.
void JudgeGains(const config::CellConfig& cell, IdentifyResult& result);

}  // namespace osteon::studies
