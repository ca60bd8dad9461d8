#pragma once

#include <vector>

#include "studies/faults/fault_case.h"

namespace osteon::studies {

/// Faults of the reamer's drive that arrive over its bus: a drive that boots in fault, a boot-up during a
/// run, an EMCY, a lost heartbeat. Each case also checks that the drive is reset (controlword bit 7) only
/// before the first motion and in a recovery.
[[nodiscard]] std::vector<FaultCase> DriveFaultCases();

}  // namespace osteon::studies
