#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 39, late planes: a hand presses on bone of 12 kg on a mount of 15 Hz, through the servo loop.
/// Metric: swing of the tool in the last half second of 2.5 s, or of the time until the loop stopped.
/// Baseline: planes that follow the bone's motion 20 ms late, as they would if the cutting engine moved the
/// bone, with the admittance law. With the impedance law the baseline swings less, since the arm has damping
/// of its own; FailureResult::note states that swing. Bound: 0.1 mm, with both laws.
[[nodiscard]] FailureResult RunLatePlanes(const FailureSetting& setting);

}  // namespace osteon::studies
