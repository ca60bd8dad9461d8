#pragma once

#include "hil/failures/failure.h"

namespace osteon::hil {

/// 14, packets. A hand presses an admittance-controlled tool into a cup of 20 N/mm and taps it; simulation
/// and arm are each behind a wire (packet_bench.h). At the second tap the wires begin to lose .1 to 5 % of
/// their datagrams, one by one or 5 to 20 in a row, to reorder them, to delay them by 1 to 10 ms where it was
/// 1, or all of it. Metric: the tool's swing 3.5 s after that tap, over the swing that the first tap made.
/// Baseline: the force is computed beyond the wire, and what is missing held or zeroed; of the two the one
/// that does better in its worst case. Bound: 1, no growth.
///
/// Ours passes if it keeps the bound in every case in which D > a_max K with the largest ages that the case
/// had (at least in three of four), and if the baseline's fault is its age: held forces grow in no case that
/// fulfils the same condition with the wall's whole stiffness.
[[nodiscard]] FailureResult RunPackets(const FailureSetting& setting);

}  // namespace osteon::hil
