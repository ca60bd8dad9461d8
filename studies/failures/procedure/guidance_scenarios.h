#pragma once

#include "studies/failures/failure.h"

// Scenarios of guidance along a surgical plan, by a funnel and a cone. They use the shipped parts, and an arm
// of 15 Hz bandwidth and 3 ms dead time.

namespace osteon::studies {

/// Scenario 27, guided cycles: a hand leads the tool out of the corridor and back, 20 times. Metric: energy
/// that the guidance has given. Baseline: the same springs without damping, evaluated at the measured pose,
/// which lags behind the command. Bound: 0.
[[nodiscard]] FailureResult RunGuidedCycles(const FailureSetting& setting);

/// Scenario 28, switched on outside: the guidance is switched on while the tool is 10 mm away from the axis.
/// The hand holds it there for a second, leads it back to the axis, and out again. Metric: largest growth of
/// the guidance's force within a tick. Baseline: the guidance has its full force at once. Bounds: 1 N, and no
/// energy given.
[[nodiscard]] FailureResult RunSwitchedOnOutside(const FailureSetting& setting);

/// Scenario 29, guidance at the ceiling: cycles in which the bone uses the cell's whole force limit while the
/// tool leaves the corridor, and little of it while the tool returns. Metric: energy that the guidance has
/// given. Baseline: the guidance uses at once whatever the bone leaves of the force limit. Bound: 0.
[[nodiscard]] FailureResult RunGuidanceAtCeiling(const FailureSetting& setting);

/// Scenario 30, firm hand at the edge: a firm hand holds the tool against the funnel. Metric: RMS value of
/// the hand's force between 5 and 40 Hz over the last second. Baseline: springs of 20 N/mm, evaluated at the
/// measured pose. Bound: 0.05 N.
[[nodiscard]] FailureResult RunFirmHandAtEdge(const FailureSetting& setting);

/// Scenario 31, let go aside: the hand leads the tool 17 mm beyond the funnel and lets go. Metric: largest
/// speed of the tool afterwards. Baseline: springs that keep their full force on the way back. Bound: 60
/// mm/s.
[[nodiscard]] FailureResult RunLetGoAside(const FailureSetting& setting);

}  // namespace osteon::studies
