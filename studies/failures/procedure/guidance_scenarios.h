#pragma once

#include "studies/failures/failure.h"

// Guidance along a surgical plan: funnel and cone, on the shipped parts with an arm of 15 Hz bandwidth and
// 3 ms dead time.

namespace osteon::studies {

/// Scenario 27, guided cycles: a hand leads the tool out of the corridor and back, 20 times. Metric: energy
/// that the guidance has given. Baseline: the same springs, undamped, at the measured pose, which is late.
/// Bound: 0.
[[nodiscard]] FailureResult RunGuidedCycles(const FailureSetting& setting);

/// Scenario 28, switched on outside: the guidance is switched on while the tool is 10 mm aside; the hand
/// holds it there for a second, leads it back to the axis, and out again. Metric: largest growth of the
/// guidance's force within a tick. Baseline: full share at once. Bound: 1 N, and no energy given.
[[nodiscard]] FailureResult RunSwitchedOnOutside(const FailureSetting& setting);

/// Scenario 29, guidance at the ceiling: cycles in which the bone takes the cell's whole force while the tool
/// leaves the corridor, and little while it returns. Metric: energy that the guidance has given. Baseline:
/// the guidance takes at once the share of the force limit that the bone leaves. Bound: 0.
[[nodiscard]] FailureResult RunGuidanceAtCeiling(const FailureSetting& setting);

/// Scenario 30, firm hand at the edge: a firm hand rests against the funnel. Metric: RMS value of its force
/// between 5 and 40 Hz over the last second. Baseline: 20 N/mm at the measured pose. Bound: 0.05 N.
[[nodiscard]] FailureResult RunFirmHandAtEdge(const FailureSetting& setting);

/// Scenario 31, let go aside: the hand leads the tool 17 mm aside and lets go. Metric: largest speed of the
/// tool afterwards. Baseline: springs that do not fade on the way back. Bound: 60 mm/s.
[[nodiscard]] FailureResult RunLetGoAside(const FailureSetting& setting);

}  // namespace osteon::studies
