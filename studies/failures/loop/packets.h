#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 14, packets. A hand presses an admittance-controlled tool into a cup of 20 N/mm and taps it;
/// simulation and arm are each behind a wire (packet_bench.h). At the second tap the wires begin to lose 0.1
/// to 5 % of their datagrams, one by one or 5 to 20 in a row, to reorder them, to delay them by 1 to 10 ms
/// instead of 1 ms, or all of these. Metric: the tool's swing 3.5 s after that tap, over the swing after the
/// first tap. Baseline: the force is computed beyond the wire, and a missing force is held or replaced by
/// zero, whichever does better in its worst case. Bound: 1, no growth.
///
/// The condition for a swing that cannot grow is D > a_max K: the law's drag is larger than the sum of
/// largest age times stiffness over both wires (AgeMargin). Ours passes if it keeps the bound in every case
/// that fulfils the condition (at least three cases in four), and if age alone explains the baseline's
/// failure: held forces grow in no case that fulfils the condition with the wall's whole stiffness.
[[nodiscard]] FailureResult RunPackets(const FailureSetting& setting);

}  // namespace osteon::studies
