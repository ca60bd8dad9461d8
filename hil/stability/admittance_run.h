#pragma once

#include "hil/stability/admittance_axis.h"

namespace osteon::hil {

/// Steps AdmittanceAxis.
/// @returns the logarithm of the growth of the motion a period. +infinity where the tool has left the wall or
/// the
///   motion has outgrown the preload; -infinity where it has died out.
/// @throws std::invalid_argument on a parameter out of range.
[[nodiscard]] double SimulatedGrowth(const AdmittanceRunParams& params);

/// The greatest wall stiffness that is seen stable: scanned upward, then bisected.
[[nodiscard]] Boundary SimulatedGreatestWall(AdmittanceRunParams params, const BoundaryScan& scan);

}  // namespace osteon::hil
