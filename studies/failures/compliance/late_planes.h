#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 39, late planes: a hand presses on bone of 12 kg on a mount of 15 Hz, through the servo loop.
/// Metric: swing of the tool in the last half second of 2.5 s, or before the loop stopped. Baseline: planes
/// that follow the bone's motion 20 ms late, as an engine would that moves the bone itself, with the
/// admittance law; the impedance law's arm has damping of its own, and the note has its figure. Bound: 0.1
/// mm, with both laws.
[[nodiscard]] FailureResult RunLatePlanes(const FailureSetting& setting);

}  // namespace osteon::studies
