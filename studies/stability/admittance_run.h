#pragma once

#include "studies/stability/admittance_axis.h"

namespace osteon::studies {

/// Steps AdmittanceAxis.
/// @returns the logarithm of the motion's growth in a period. +infinity if the tool has left the wall or the
///   motion has outgrown the preload; -infinity if it has died out.
/// @throws std::invalid_argument on a parameter out of range.
[[nodiscard]] double SimulatedGrowth(const AdmittanceRunParams& params);

/// The largest wall stiffness that is observed stable: scans upward, then bisects.
[[nodiscard]] hil::Boundary SimulatedMaxWallStiffness(AdmittanceRunParams params,
                                                      const hil::BoundaryScan& scan);

}  // namespace osteon::studies
