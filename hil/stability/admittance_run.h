#pragma once

#include <cstdint>

#include "hil/stability/admittance_loop.h"

namespace osteon::hil {

/// The loop of Model B run in time, part by part: what the matrix leaves out is in it.
struct AdmittanceRunParams {
  AdmittanceLoopParams loop;
  double preload_N{60.0};     ///< the hand presses on the wall with this; without a wall it pushes nothing
  double kick_m_per_s{1e-4};  ///< of the virtual tool, at the beginning
  double command_loss{0.0};   ///< share of commands that never reach the arm, which then holds its last one
  int command_jitter{0};      ///< a command is late by 0 … so many ticks more; their order stays
  double seconds{4.0};        ///< the growth is that of the second half
  std::uint64_t seed{1};
};

/// Steps the shipped parts against each other: EvaluateCoupling on a plane (a wall on commanded poses as old
/// as asked), StepAdmittance, ServoArm with its dead time, the hand's linear spring, damper and mass;
/// commands that get lost or come late.
/// @returns the logarithm of the growth of the motion a period. +infinity where the tool has left the wall or
/// the
///   motion has outgrown the preload; -infinity where it has died out.
/// @throws std::invalid_argument on a parameter out of range.
[[nodiscard]] double SimulatedGrowth(const AdmittanceRunParams& params);

/// The greatest wall stiffness that is seen stable: scanned upward, then bisected.
[[nodiscard]] Boundary SimulatedGreatestWall(AdmittanceRunParams params, const BoundaryScan& scan);

}  // namespace osteon::hil
