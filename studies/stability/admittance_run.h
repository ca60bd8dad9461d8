#pragma once

#include "studies/stability/admittance_axis.h"

namespace osteon::studies {

/// Simulates AdmittanceAxis.
/// @returns the logarithm of the motion's growth per period. +infinity if the tool has left the wall, or if
/// the motion has become too large for the preload; -infinity if the motion has died out.
/// @throws std::invalid_argument if a parameter is out of range.
[[nodiscard]] double SimulatedGrowth(const AdmittanceRunParams& params);

/// Finds the largest wall stiffness with which the simulation is stable: scans upward, then bisects.
[[nodiscard]] hil::Boundary SimulatedMaxWallStiffness(AdmittanceRunParams params,
                                                      const hil::BoundaryScan& scan);

}  // namespace osteon::studies
