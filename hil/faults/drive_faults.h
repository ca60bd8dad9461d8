#pragma once

#include <vector>

#include "hil/faults/fault_case.h"

namespace osteon::hil {

/// Faults of the reamer's drive as they come over its bus: a drive that boots in fault, a boot-up in mid-run,
/// an EMCY, a heartbeat that is lost. Each also sees to it that the drive is reset (controlword bit 7) before
/// the first motion and in a recovery, and at no other time.
[[nodiscard]] std::vector<FaultCase> DriveFaultCases();

}  // namespace osteon::hil
