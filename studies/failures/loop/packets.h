#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 14, packets. A hand presses an admittance-controlled tool into a cup of 20 N/mm and taps it
/// twice. Simulation and arm are each behind a wire (packet_bench.h). At the second tap the wires begin to
/// lose 0.1 to 5 % of their datagrams, one by one or 5 to 20 in a row, to reorder them, to delay them by 1 to
/// 10 ms instead of 1 ms, or all of these. Metric: the tool's swing 3.5 s after the second tap, divided by
/// the swing after the first tap. Baseline: the force is computed beyond the wire. A missing force is held or
/// replaced by zero; the better of the two methods, each in its worst case, is the baseline. Bound: 1, no
/// growth.
///
/// A swing cannot grow if D > a_max K: the law's drag D is larger than the sum, over both wires, of the
/// largest age a_max times the stiffness K (AgeMargin). Ours passes if it keeps the bound in every case that
/// fulfils the condition, and at least three of four cases fulfil it. The baseline fails as expected if held
/// forces grow in some cases, but in none that fulfils the condition with the wall's whole stiffness: age
/// alone explains the growth.
[[nodiscard]] FailureResult RunPackets(const FailureSetting& setting);

}  // namespace osteon::studies
